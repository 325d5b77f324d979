//! What an operator sees of a running system: plain data, as it goes over the socket.

use std::collections::BTreeMap;

use fault_manager::Condition;
use serde::Serialize;
use system_model::life_cycle::LifeCycleState;

use crate::summary::ComponentSummary;

/// The answer to `status`.
#[derive(Debug, Clone, Serialize)]
pub struct SystemView {
    /// The state of each application, by its name: `ACTIVE`, `DEGRADED` or `STOPPED`.
    pub applications: BTreeMap<String, &'static str>,
    /// `real` or `simulated`.
    pub clock: &'static str,
    /// Since the start of the run, by that clock.
    pub time_s: f64,
    /// Whether an emergency stop is latched.
    pub emergency_stop: bool,
    /// How many verdicts have been put on record: if it is the same as before, none has changed.
    pub verdicts_recorded: u64,
    /// The process that all of it runs in.
    pub container: ContainerView,
    /// By instance name.
    pub components: BTreeMap<String, ComponentView>,
    /// Behaviour trees, by name.
    pub trees: BTreeMap<String, TreeView>,
}

/// One behaviour tree.
#[derive(Debug, Clone, Serialize)]
pub struct TreeView {
    /// `waiting`, `running`, `success`, `failure`, `failed` or `stopped`.
    pub state: &'static str,
    /// The leaves that are at work, by their paths.
    pub doing: Vec<String>,
    /// Ticks so far.
    pub ticks: u64,
    /// How long the longest took, in milliseconds of the machine's clock; 0 where time is simulated.
    pub longest_tick_ms: f64,
}

/// The container.
#[derive(Debug, Clone, Serialize)]
pub struct ContainerView {
    /// Number of the process.
    pub process: u32,
    /// Since it was started, by the machine's clock.
    pub uptime_s: f64,
    /// Threads of the process.
    pub threads: usize,
    /// How often it was restarted by the parent that supervises it.
    pub restarts: u32,
    /// Data of ports that were overwritten before they were read.
    pub port_data_dropped: u64,
    /// Events that the event file's writer did not keep up with.
    pub events_lost: u64,
    /// Symptoms that were not judged because too many came at once.
    pub symptoms_dropped: u64,
}

/// One component.
#[derive(Debug, Clone, Serialize)]
pub struct ComponentView {
    /// Its application.
    pub application: String,
    /// What it comes to: `OK`, `WARN`, `ERROR` or `STALE`.
    pub level: &'static str,
    /// What the container knows of it.
    #[serde(flatten)]
    pub summary: ComponentSummary,
    /// How the fault manager sees it: `working`, `recovering`, `waiting`, `stopped`, `destroyed` or
    /// `lost`.
    pub condition: &'static str,
    /// Faults that are confirmed and not healed.
    pub open_faults: usize,
    /// The component type whose library runs: its own, or that of a secondary.
    pub runs: String,
    /// Name of its executor: that of the executor's first component.
    pub executor: String,
    /// `periodic`, `periodic-shared`, `aperiodic` or `passive`.
    pub execution: &'static str,
    /// Period of its executor, if it has one.
    pub period_ms: Option<f64>,
    /// Completed cycles per second, over the last second.
    pub rate_hz: Option<f64>,
    /// How much of its period its executor's cycle takes, over the last second.
    pub load_percent: Option<f64>,
    /// Instances that stand by, as rules want them.
    pub standbys: Vec<StandbyView>,
}

/// One instance that a rule wants to stand by.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StandbyView {
    /// The component type.
    pub of: String,
    /// `loaded` or `warm`.
    pub preload: &'static str,
    /// Whether it is there.
    pub ready: bool,
}

/// The answer to `component_info`.
#[derive(Debug, Clone, Serialize)]
pub struct ComponentInfo {
    /// Instance name.
    pub name: String,
    /// As in `status`.
    #[serde(flatten)]
    pub view: ComponentView,
    /// Its profile.
    pub profile: String,
    /// The file of the library that runs.
    pub library: String,
    /// Node; empty for the local one.
    pub node: String,
    /// Priority of its executor's thread, 0 to 99.
    pub priority: u8,
    /// Scheduling policy that was asked for.
    pub policy: &'static str,
    /// Bytes that its callbacks have allocated and not freed, where a rule asks; else 0.
    pub allocated_bytes: u64,
    /// Properties, later values win.
    pub properties: Vec<(String, String)>,
    /// The component types that may take its place, in order.
    pub secondaries: Vec<String>,
    /// Its ports.
    pub ports: Vec<PortView>,
    /// Its faults, the oldest first.
    pub faults: Vec<FaultView>,
}

/// One port.
#[derive(Debug, Clone, Serialize)]
pub struct PortView {
    /// Name.
    pub name: String,
    /// `data`, `event` or `service`.
    pub kind: &'static str,
    /// `input` or `output`; `provided` or `required` of a service.
    pub usage: &'static str,
    /// Its data type; empty for none.
    pub data_type: String,
    /// What it is connected with: `component.port`.
    pub connected: Vec<String>,
    /// Data that were overwritten before this input read them.
    pub dropped: u64,
}

/// Data that were dropped between an output and an input: `component.port` of both.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LinkView {
    /// The output.
    pub source: String,
    /// The input.
    pub target: String,
    /// So many.
    pub dropped: u64,
}

/// One fault, in short.
#[derive(Debug, Clone, Serialize)]
pub struct FaultView {
    /// Its number, for `fault show`.
    pub id: u64,
    /// Kind.
    pub kind: &'static str,
    /// Where it stands.
    pub state: fault_manager::FaultState,
}

/// What a component comes to, in the words of diagnostics. `ERROR`: it should run and does not.
/// `STALE`: it was stopped, so nothing of it is news. `WARN`: it works, but something is or may be
/// wrong.
pub fn level(state: LifeCycleState, condition: Condition, open_faults: usize) -> &'static str {
    match (condition, state) {
        (Condition::Stopped | Condition::Destroyed | Condition::Unneeded, _) => "STALE",
        (Condition::Lost, _) => "ERROR",
        (Condition::Recovering | Condition::Waiting, _) => "WARN",
        (Condition::Working, LifeCycleState::Error) => "ERROR",
        (Condition::Working, LifeCycleState::Active) if open_faults == 0 => "OK",
        (Condition::Working, LifeCycleState::Active) => "WARN",
        (Condition::Working, _) => "STALE",
    }
}

/// The word for how the fault manager sees a component.
pub fn condition_name(condition: Condition) -> &'static str {
    match condition {
        Condition::Working => "working",
        Condition::Recovering => "recovering",
        Condition::Waiting => "waiting",
        Condition::Stopped => "stopped",
        Condition::Destroyed => "destroyed",
        Condition::Lost => "lost",
        Condition::Unneeded => "done without",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels() {
        use Condition::{Lost, Recovering, Stopped, Waiting, Working};
        use LifeCycleState::{Active, Error, Inactive, Ready};
        for (state, condition, faults, expected) in [
            (Active, Working, 0, "OK"),
            (Active, Working, 2, "WARN"),
            (Error, Recovering, 1, "WARN"),
            (Error, Waiting, 1, "WARN"),
            (Error, Working, 0, "ERROR"),
            (Error, Lost, 1, "ERROR"),
            (Inactive, Stopped, 1, "STALE"),
            (Error, Stopped, 1, "STALE"),
            (Ready, Working, 0, "STALE"),
        ] {
            let found = level(state, condition, faults);
            assert_eq!(found, expected, "{state} {condition:?} {faults}");
        }
    }
}
