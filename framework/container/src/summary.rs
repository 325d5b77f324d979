//! The summary of a run, for people and as JSON.

use std::collections::BTreeMap;

use robot_simulation::RobotSummary;
use serde::Serialize;
use system_model::life_cycle::LifeCycleState;

use crate::status::ComponentStatus;

/// What a run came to.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// By application name.
    pub applications: BTreeMap<String, ApplicationSummary>,
    /// By instance name.
    pub components: BTreeMap<String, ComponentSummary>,
    /// The robot of the simulated world, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<RobotSummary>,
}

/// One application.
#[derive(Debug, Clone, Serialize)]
pub struct ApplicationSummary {
    /// `ACTIVE` if all its components were active when the run ended, `DEGRADED` if any was in
    /// ERROR.
    pub state: &'static str,
    /// Why the run ended.
    pub ended_by: &'static str,
    /// How long it ran, by the container's clock.
    pub time_s: f64,
    /// `real` or `simulated`.
    pub clock: &'static str,
    /// Seed of the simulated world.
    pub seed: u64,
    /// Events that the writer did not keep up with.
    pub events_lost: u64,
}

/// One component, as it was when the run ended.
#[derive(Debug, Clone, Serialize)]
pub struct ComponentSummary {
    /// Life-cycle state.
    pub state: &'static str,
    /// Which instance, counted from 1.
    pub incarnation: u32,
    /// Completed `onExecute`.
    pub cycles: u64,
    /// Cycles of its executor that took longer than the period.
    pub overruns: u64,
    /// Faults.
    pub faults: u64,
    /// The last fault, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_fault: Option<String>,
    /// Isolation tier.
    pub tier: &'static str,
}

impl ComponentSummary {
    /// What is known of the component now.
    pub fn of(status: &ComponentStatus) -> Self {
        Self {
            state: status.state().name(),
            incarnation: status.incarnation(),
            cycles: status.cycles(),
            overruns: status.overruns(),
            faults: status.faults(),
            last_fault: status.last_fault(),
            tier: "guarded",
        }
    }
}

/// The application's state, from those of its components.
pub fn application_state(states: impl IntoIterator<Item = LifeCycleState>) -> &'static str {
    if states
        .into_iter()
        .any(|state| matches!(state, LifeCycleState::Error | LifeCycleState::Destroyed))
    {
        "DEGRADED"
    } else {
        "ACTIVE"
    }
}
