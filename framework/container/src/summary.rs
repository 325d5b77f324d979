//! The summary of a run, for people and as JSON.

use std::collections::BTreeMap;
use std::sync::Arc;

use robot_simulation::RobotSummary;
use serde::Serialize;
use system_model::life_cycle::LifeCycleState;

use crate::adaptation::AdaptationSummary;
use crate::recording::RecordingSummary;
use crate::status::ComponentStatus;

/// What a run came to.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// By application name.
    pub applications: BTreeMap<String, ApplicationSummary>,
    /// By instance name.
    pub components: BTreeMap<String, ComponentSummary>,
    /// How often the container was restarted by the parent that supervises it.
    pub restarts: u32,
    /// The robot of the simulated world, if there is one; of several, that of the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<RobotSummary>,
    /// Where there are several worlds, the robot of each, by the first application that drives in it.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub robots: BTreeMap<String, RobotSummary>,
    /// What self-adaptation has come to, if a task was watched over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adaptation: Option<AdaptationSummary>,
    /// What was recorded, if anything was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recording: Option<RecordingSummary>,
}

/// One application.
#[derive(Debug, Clone, Serialize)]
pub struct ApplicationSummary {
    /// `ACTIVE` if all its components were active when the run ended, `STOPPED` if none was,
    /// else `DEGRADED`.
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
            tier: status.tier(),
        }
    }
}

/// The application's state, from those of its components. `STOPPED`: none of them runs.
pub fn application_state(components: &[Arc<ComponentStatus>]) -> &'static str {
    let is_active = |one: &&Arc<ComponentStatus>| one.state() == LifeCycleState::Active;
    let dormant = components.iter().filter(|one| one.is_dormant()).count();
    match components.iter().filter(is_active).count() {
        count if count + dormant >= components.len() => "ACTIVE",
        0 => "STOPPED",
        _ => "DEGRADED",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_application_is_what_its_components_are() {
        use LifeCycleState::{Active, Destroyed, Error, Inactive};
        for (states, expected) in [
            (&[][..], "ACTIVE"),
            (&[Active, Active], "ACTIVE"),
            (&[Active, Error], "DEGRADED"),
            (&[Inactive, Active], "DEGRADED"),
            (&[Inactive, Error, Destroyed], "STOPPED"),
        ] {
            let component = |state: &LifeCycleState| {
                let status = ComponentStatus::new("camera".to_owned());
                status.set_state(*state);
                Arc::new(status)
            };
            let components: Vec<_> = states.iter().map(component).collect();
            assert_eq!(application_state(&components), expected, "{states:?}");
        }
    }
}
