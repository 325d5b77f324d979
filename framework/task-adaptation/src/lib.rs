//! Self-adaptation: a task that fails though every component runs is done in another way.
//!
//! After the paper on ReFrESH, an infrastructure for self-adaptation of resource-constrained
//! multi-robot systems. Its definitions and equations are named where they are:
//!
//! * Definition 1, extended port-based objects: an evaluator says how well a component does that
//!   runs, an estimator how well one would do that does not. Here they are
//!   [`ComponentPerformance`]s; where they come from is the shell's matter.
//! * Definition 2, the composition across robots: [`Candidate`].
//! * Definition 3, Equation (1), the task: `system_model::task::TaskSpecification`.
//! * Definitions 4 and 5, Equation (2), essential and complex solutions, and the generator:
//!   [`generate`].
//! * Definition 6, Equations (3) to (8), quality: [`quality`].
//! * The decider with its four states: [`Decider`]; one decision without a robot: [`plan()`].
//!
//! Nothing here reads a clock, starts a thread or does input or output.

#![forbid(unsafe_code)]

mod decider;
mod estimate;
mod generator;
mod hops;
mod judge;
mod monitor;
mod placing;
mod plan;
pub mod quality;
mod resources;
mod solution;
mod verdict;
mod wording;

pub use decider::{Decider, DeciderState, Effect, Observation};
pub use estimate::{Answer, Implausible, given, implausible};
pub use generator::{Candidate, Generation, GenerationError, Room, generate};
pub use judge::{Choice, choose, judge, judge_all, nearest};
pub use plan::{Difference, Plan, plan};
pub use quality::{ComponentPerformance, Quality};
pub use resources::Shortage;
pub use verdict::{
    GenerationFailure, Judged, Nearest, Outcome, Phases, Rejection, Trigger, Verdict,
};
