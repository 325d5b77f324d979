//! Recordings: port data, events, states, verdicts and diagnostics of a running system as MCAP
//! files, which Foxglove and every MCAP library read.
//!
//! Messages and schemas are JSON (encodings `json` and `jsonschema`), so no definition of ours is
//! needed to read them. Times are nanoseconds of the container's clock, as in the event file. This
//! is the only crate that knows the file format.
//!
//! * [`Layout`]: from a port's descriptor to a schema, and its data to JSON and back.
//! * [`RecordingWriter`]: a file that grows, readable up to its last chunk whenever it is cut.
//! * [`read`]: a file's messages, one after the other.
#![forbid(unsafe_code)]

mod channel;
mod diagnostics;
mod error;
mod layout;
mod reader;
mod writer;

pub use channel::{Channel, Topic};
pub use diagnostics::{DiagnosticArray, DiagnosticStatus, KeyValue, Level, Stamp};
pub use error::{ReadError, WriteError};
pub use layout::{Layout, Misfit};
pub use reader::{Message, Reader, read};
pub use writer::{ChannelId, RecordingWriter};
