//! Why a recording cannot be written or read.

use std::path::PathBuf;

/// A recording that cannot be written any further.
#[derive(Debug, thiserror::Error)]
#[error(
    "recording {path} cannot be written: {reason}\n  help: is there room on the disk, and may its user write there?"
)]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// Why, in words.
    pub reason: String,
}

/// A file that is no recording, or one that cannot be read any further.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error(
        "{path} cannot be read: {error}\n  help: name a recording that `steadfast run --record` or `--black-box` wrote"
    )]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// It is no MCAP file, or damaged.
    #[error(
        "{path} is no MCAP file, or damaged after {messages} messages: {reason}\n  help: what is before the damage can be saved with `mcap recover`"
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Messages read before.
        messages: u64,
        /// Why, in words.
        reason: String,
    },
    /// A message that is not JSON.
    #[error(
        "{path}: topic '{topic}' is encoded as '{encoding}', not as JSON\n  help: only recordings of steadfast can be read; convert the file, or leave the topic out"
    )]
    Encoding {
        /// The file.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// Its message encoding.
        encoding: String,
    },
}
