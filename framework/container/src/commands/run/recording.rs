//! What `steadfast run` records.

use std::path::PathBuf;

use clap::Args;
use container::recording::RecordingOptions;

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
}

impl RecordingArguments {
    /// As the container takes them.
    pub(super) fn options(&self) -> RecordingOptions {
        RecordingOptions {
            file: self.record.clone(),
            black_box: None,
            most_bytes_per_datum: Some(self.record_max_bytes_per_datum),
        }
    }
}
