//! Checkpoints that outlive the process: copies of registered memory on disk, from which a container
//! that died goes on when it is started again.
//!
//! An executor hands each certified copy over and never waits; a thread of its own writes the
//! newest one of each component, at most ten times a second, over the older of two files. A run that
//! ends in order removes its files: those that are there belong to a run that did not.

mod folder;
mod handover;
mod record;
mod slots;
mod writer;

pub use folder::{Store, StoreError, base_folder};
pub use handover::{CopyReceiver, CopySender, SentCopy, handover};
pub use record::{CLOCK_TOLERANCE, LARGEST_MEMORY, LibraryIdentity, Origin, Record, Refusal};
pub use slots::{Found, RefusedFile, Slots};
pub use writer::{Kept, Writer};
