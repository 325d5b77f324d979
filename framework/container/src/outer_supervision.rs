//! The container is supervised too: by a small parent process that runs no code of components and
//! loads no library.
//!
//! The parent starts the container as its child, listens whether it lives, restarts it after a
//! crash or a hang, keeps actuators in their safe state meanwhile, and gives up when the budget is
//! used up. What the two say to each other goes over one socket, the child's standard input when it
//! starts ([`Supervised`]). The simulated world is a second child, which outlives the container.

mod bond;
mod budget;
mod hardware_watchdog;
mod judgement;
mod liveness;
mod messages;
mod parent;
mod process;
mod safe_states;
mod service_manager;
mod signals;
mod supervised;
mod world_process;

use std::time::Duration;

use nix::time::{ClockId, clock_gettime};

pub use bond::{die_with_parent, take_line};
pub use budget::{DEFAULT_RESTARTS, RESTART_WINDOW};
pub use liveness::{DEFAULT_BEAT_LIMIT, LEAST_BEAT_LIMIT};
pub use parent::{GIVEN_UP, Plan, PlannedWorld, SuperviseError, supervise};
pub use supervised::{ContainerRestart, Supervised};

/// The machine's monotonic clock, which all processes share. Zero if there is none, which no Linux
/// lacks.
fn monotonic() -> Duration {
    clock_gettime(ClockId::CLOCK_MONOTONIC).map_or(Duration::ZERO, Duration::from)
}
