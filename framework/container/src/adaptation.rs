//! Self-adaptation in a running system (ReFrESH): the shell around the decider of `task-adaptation`.
//! A task that fails though every component runs is done in another way.
//!
//! A task is attached to an application from outside ([`AttachedTask`]): components need not know.
//! `binding` finds its names in the application; `local` listens to outputs, `evaluation` makes
//! errors of what is heard, `estimation` lets fresh instances of what does not run work on current
//! data, `change` goes from one way of doing the task to another. `team` does all that together with
//! other robots: one of them decides (`asking`, `leading`), the others report and do what it asks for
//! (`reporting`, `following`). All of
//! it is on a lane of its own where time is real, else on the one thread.

mod asking;
mod binding;
mod change;
mod connecting;
mod estimation;
mod evaluation;
mod following;
mod known;
mod lane;
mod leading;
mod linking;
mod local;
mod losses;
mod outlet;
mod overruns;
mod passage;
mod record;
mod rehearsal;
mod reporting;
mod requests;
mod settling;
mod shadow;
mod shell;
mod team;
mod wiring;

use system_model::specification::Place;
use system_model::task::{RobotIndex, TaskSpecification};

pub use binding::Binding;
pub use known::Known;
pub use lane::AdaptationLane;
pub use local::LocalRobot;
pub use passage::{Passage, Teammates};
pub use record::{AdaptationRecord, CandidateRecord, PhaseRecord};
pub use requests::{AdaptationRequests, AdaptationSummary};
pub use shell::Adaptation;
pub use team::Team;
pub use wiring::{Hop, description};

/// A task, and where it is attached.
#[derive(Debug, Clone, PartialEq)]
pub struct AttachedTask {
    /// The task.
    pub task: TaskSpecification,
    /// The robot of the task on which the application runs.
    pub robot: RobotIndex,
    /// The rule that says so.
    pub place: Place,
}
