//! What a parent is to do, and why it may not be able to.

use std::ffi::OsString;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

use system_model::rules::SafeStateRule;

use crate::outer_supervision::process::KILL_LIMIT;

/// Exit code of a parent that has given up.
pub const GIVEN_UP: u8 = 7;

/// What a parent is to do.
#[derive(Debug)]
pub struct Plan {
    /// The binary that containers and worlds are.
    pub executable: PathBuf,
    /// What a container is called with, but for the number of its parent.
    pub arguments: Vec<OsString>,
    /// The simulated world, if the applications drive in one.
    pub world: Option<PlannedWorld>,
    /// How often the container may be restarted within [`RESTART_WINDOW`](crate::outer_supervision::RESTART_WINDOW).
    pub restarts: u32,
    /// How long a running container may be silent.
    pub beat_limit: Duration,
    /// The watchdog device of the machine, if it is to be used.
    pub hardware_watchdog: Option<PathBuf>,
    /// What actuators are told while no container runs.
    pub safe_states: Vec<SafeStateRule>,
    /// Where containers write their events; each goes on where the one before has ended.
    pub events: Option<PathBuf>,
}

/// The simulated world of a run.
#[derive(Debug)]
pub struct PlannedWorld {
    /// Its file.
    pub file: PathBuf,
    /// Its seed.
    pub seed: u64,
}

/// Why a parent has nothing (more) to supervise.
#[derive(Debug, thiserror::Error)]
pub enum SuperviseError {
    /// A file cannot be opened or written.
    #[error(
        "{} cannot be opened or written: {error}\n  help: see that it is there and that you may write to it",
        .path.display()
    )]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// The system refuses.
    #[error(
        "the container cannot be supervised: {0}\n  help: see the limits of this user: processes, open files; or run it without --supervised"
    )]
    System(#[from] io::Error),
    /// A killed container does not end.
    #[error(
        "the container was killed and has not ended within {} s: it waits for hardware that does not answer\n  help: see the devices that its components open; only a restart of the machine may free it",
        KILL_LIMIT.as_secs()
    )]
    DoesNotEnd,
    /// The simulated world has ended by itself.
    #[error(
        "the process of the simulated world has ended, and the run with it\n  help: what it said stands above; start the run again"
    )]
    WorldEnded,
}
