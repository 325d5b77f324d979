//! What happens in a running system, put down as MCAP files: all of it, or what lies around faults.
//!
//! A port that is recorded has a tap, which copies each datum into a bounded ring of its own and
//! goes on; without a recording there is none. One thread of normal priority empties the rings, puts
//! data and events in the order of time, makes JSON of them and writes. Where time is real a ring
//! that is full drops the newest datum and counts it; in simulated time its writer waits.

mod black_box;
mod diagnosis;
mod options;
mod port_recorder;
mod record_file;
mod recorder;
mod sinks;
mod thread;
mod writing;

pub use options::{BlackBoxOptions, RecordingOptions};
pub use port_recorder::{EventRecorder, PortRecorder};
pub use recorder::Recorder;
pub use thread::{RecordingSummary, RecordingThread};
