//! What `steadfast run` records.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use container::recording::{BlackBoxOptions, RecordingOptions};

use super::duration;

/// A megabyte is so many bits up.
const MEGABYTE_BITS: u32 = 20;

/// Whether, what and where is recorded.
#[derive(Debug, Args)]
pub(super) struct RecordingArguments {
    /// Record every port, event, state and verdict as MCAP, for Foxglove, `steadfast replay` and
    /// every MCAP library
    #[arg(long, value_name = "FILE.mcap")]
    record: Option<PathBuf>,
    /// Leave ports out whose data are longer
    #[arg(long, value_name = "BYTES", default_value_t = RecordingOptions::MOST_BYTES_PER_DATUM)]
    record_max_bytes_per_datum: usize,
    /// Keep the last seconds in memory, and write a file into this folder around every fault
    #[arg(long, value_name = "FOLDER")]
    black_box: Option<PathBuf>,
    /// How long before a fault was confirmed its file begins [default: 5s]
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, requires = "black_box")]
    black_box_before: Option<Duration>,
    /// How long after it the file ends [default: 2s]
    #[arg(long, value_name = "DURATION", value_parser = duration::parse, requires = "black_box")]
    black_box_after: Option<Duration>,
    /// How much of the last seconds is held in memory, in megabytes [default: 64]
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u16).range(1..), requires = "black_box")]
    black_box_memory: Option<u16>,
    /// How much its files may have together, in megabytes: the oldest are removed [default: 1024]
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u32).range(1..), requires = "black_box")]
    black_box_size: Option<u32>,
}

impl RecordingArguments {
    fn black_box(&self, folder: &Path) -> BlackBoxOptions {
        let usual = BlackBoxOptions::new(folder.to_owned());
        let memory = self
            .black_box_memory
            .map(|it| usize::from(it) << MEGABYTE_BITS);
        let size = self.black_box_size.map(|it| u64::from(it) << MEGABYTE_BITS);
        BlackBoxOptions {
            before: self.black_box_before.unwrap_or(usual.before),
            after: self.black_box_after.unwrap_or(usual.after),
            memory_bytes: memory.unwrap_or(usual.memory_bytes),
            folder_bytes: size.unwrap_or(usual.folder_bytes),
            ..usual
        }
    }

    /// As the container takes them.
    pub(super) fn options(&self) -> RecordingOptions {
        RecordingOptions {
            file: self.record.clone(),
            black_box: self
                .black_box
                .as_deref()
                .map(|folder| self.black_box(folder)),
            most_bytes_per_datum: Some(self.record_max_bytes_per_datum),
        }
    }
}
