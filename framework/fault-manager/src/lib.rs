//! The fault manager: observations and time in, effects out.
//!
//! It reads no clock, starts no thread and does no input or output, so that every set of rules can
//! be tested, replayed and explored without a robot. The container is the thin shell that observes
//! and acts.
//!
//! A detector raises a symptom; symptoms pass a debounce and become a fault; a fault is diagnosed
//! (severity, root cause or consequence) and handled by a ladder: reset, secondaries in order,
//! severity of the application, emergency stop. Ahn et al. (2012), sections 2.2 to 3.4.
//!
//! Where the rules leave a choice:
//!
//! * A component that does not run any more needs no second symptom, whatever the debounce says, and
//!   is never left in ERROR for ever: as a consequence it waits only until its cause has been
//!   handled; then its trouble becomes a new fault, a root cause, and the consequence is closed.
//! * What befalls a component during its own recovery belongs to that recovery, save an emergency
//!   and a fault of severity `stop`. A new instance that fails before its first cycle has failed the
//!   attempt. Components that do not run in periods have recovered when the action has ended.
//! * Resets in vain count against the budget even when the window has passed.
//! * A fault to be ignored that leaves its component in ERROR loses it: what needs it is stopped.
//! * During an emergency stop faults are recorded and stops carried out; recoveries wait. Afterwards
//!   what is still in ERROR is recovered, whatever its severity was.
//! * What an operator orders is a verdict of its own. A reset that he orders begins the ladder anew; if
//!   it fails the next rung follows, as ever.
//! * A component that an operator starts again ends its faults, and is stopped again if it lacks
//!   what it needs.
#![forbid(unsafe_code)]

mod actions;
mod correlation;
pub mod detection;
mod detectors;
mod emergency;
mod evidence;
mod graph;
mod handling;
mod handling_by_tree;
mod history;
mod ladder;
mod life;
mod manager;
mod observation;
mod operator;
mod plan;
mod state;
mod stopping;
mod symptoms;
mod system;
mod verdict;
pub mod what_if;
mod wording;

pub use evidence::{Evidence, Number};
pub use manager::FaultManager;
pub use observation::{
    ActionOutcome, Detector, DetectorId, DetectorKind, Observation, OperatorOrder, Symptom,
};
pub use plan::{Action, ActionId, Effect, PlannedAction};
pub use state::Condition;
pub use system::Scope;
pub use verdict::{ActionRecord, Cause, FaultId, FaultState, Severity, Verdict};
