//! What is recorded, and where.

use std::path::PathBuf;
use std::time::Duration;

/// What is recorded of a run.
#[derive(Debug, Clone, Default)]
pub struct RecordingOptions {
    /// Everything, into this file.
    pub file: Option<PathBuf>,
    /// What lies around faults, into a folder.
    pub black_box: Option<BlackBoxOptions>,
    /// Ports whose data are longer than so many bytes are left out; `None`:
    /// [`Self::MOST_BYTES_PER_DATUM`].
    pub most_bytes_per_datum: Option<usize>,
}

/// A black box.
#[derive(Debug, Clone)]
pub struct BlackBoxOptions {
    /// Where its files lie.
    pub folder: PathBuf,
    /// How long before a fault was confirmed a file begins.
    pub before: Duration,
    /// How long after it a file ends.
    pub after: Duration,
    /// Bytes that may be held in memory; when there are more, a file begins later.
    pub memory_bytes: usize,
    /// Bytes that its files may have together; the oldest ones are removed for a new one.
    pub folder_bytes: u64,
}

impl RecordingOptions {
    /// A picture of 160 x 120 pixels has 57 kB; one of a megapixel at 30 Hz would be 90 MB of every
    /// second, more than an ordinary disk takes: whoever wants that says so.
    pub const MOST_BYTES_PER_DATUM: usize = 256 << 10;

    /// Whether anything is recorded.
    pub fn any(&self) -> bool {
        self.file.is_some() || self.black_box.is_some()
    }
}

impl BlackBoxOptions {
    /// Time for what led to a fault: several looks of the slowest detectors (process models need
    /// about a second).
    pub const BEFORE: Duration = Duration::from_secs(5);
    /// Time for a recovery, and to see whether it holds: the slowest take a second.
    pub const AFTER: Duration = Duration::from_secs(2);
    /// The reference robot makes 1 MB a second with its camera: half a minute and more.
    pub const MEMORY_BYTES: usize = 64 << 20;
    /// Some ten minutes of the reference robot, or eighty faults.
    pub const FOLDER_BYTES: u64 = 1 << 30;

    /// With the usual times and bounds.
    pub fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            before: Self::BEFORE,
            after: Self::AFTER,
            memory_bytes: Self::MEMORY_BYTES,
            folder_bytes: Self::FOLDER_BYTES,
        }
    }
}
