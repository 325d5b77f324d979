//! What a host is told of an instance that it is to run.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use system_model::rules::ProcessLimits;

use super::layout::Layout;

/// Everything about one instance that does not change.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Setup {
    /// Instance name.
    pub(super) component: String,
    /// The component's number in the application.
    pub(super) number: u32,
    /// The library's file.
    pub(super) library: PathBuf,
    /// Of the shared memory.
    pub(super) layout: Layout,
    /// What the machine's monotonic clock showed when the container's began, in nanoseconds;
    /// nothing if the container's goes by itself.
    pub(super) clock_began_ns: Option<u64>,
    /// Whether a rule asks how much memory the component uses.
    pub(super) counts_allocations: bool,
    /// Bounds of the process; those of the first instance hold.
    #[serde(with = "Limits")]
    pub(super) limits: ProcessLimits,
}

/// As [`ProcessLimits`], for the way to the host.
#[derive(Serialize, Deserialize)]
#[serde(remote = "ProcessLimits")]
struct Limits {
    memory_bytes: Option<u64>,
    open_files: Option<u64>,
    processor_time_s: Option<u64>,
    filters_system_calls: bool,
}
