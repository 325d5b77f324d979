//! The fault manager: observations and time in, effects out.
//!
//! It reads no clock, starts no thread and does no input or output, so that every set of rules can
//! be tested, replayed and explored without a robot. The container is the thin shell that observes
//! and acts.
//!
//! A detector raises a symptom; symptoms pass a debounce and become a fault; a fault is diagnosed
//! (severity, root cause or consequence) and handled by a ladder: reset, secondaries in order,
//! severity of the application, emergency stop. Ahn et al. (2012), sections 2.2 to 3.4.
#![forbid(unsafe_code)]

mod actions;
mod correlation;
pub mod detection;
mod detectors;
mod emergency;
mod graph;
mod handling;
mod history;
mod ladder;
mod life;
mod manager;
mod observation;
mod plan;
mod state;
mod stopping;
mod symptoms;
mod system;
mod verdict;
mod wording;

pub use manager::FaultManager;
pub use observation::{
    ActionOutcome, Detector, DetectorId, DetectorKind, Evidence, Number, Observation, Symptom,
};
pub use plan::{Action, ActionId, Effect, PlannedAction};
pub use state::Condition;
pub use system::Scope;
pub use verdict::{ActionRecord, Cause, FaultId, FaultState, Severity, Verdict};
