//! What is known of a run, as a report tells it.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

/// Which fault: a container that was restarted counts its faults from 1 again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FaultNumber {
    /// The how manieth container of the run, from 1.
    pub(super) container: u32,
    /// Its `id` there.
    pub(super) id: u64,
}

impl std::fmt::Display for FaultNumber {
    /// `7`, and of a second container `2.7`.
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.container {
            1 => write!(formatter, "{}", self.id),
            container => write!(formatter, "{container}.{}", self.id),
        }
    }
}

/// One run.
#[derive(Debug, Default)]
pub(super) struct Run {
    /// Files that tell of it.
    pub(super) sources: Vec<String>,
    /// Name of the application, or several.
    pub(super) application: String,
    /// `real` or `simulated`.
    pub(super) clock: String,
    /// Seed of the simulated world.
    pub(super) seed: Option<u64>,
    /// Time of the first and the last event, in nanoseconds of the run's clock.
    pub(super) span_ns: Option<(u64, u64)>,
    /// Why it ended; none if the file does not tell.
    pub(super) ended_by: Option<String>,
    /// Events that the file lacks.
    pub(super) events_lost: u64,
    /// Life-cycle states, in the order of time, by component.
    pub(super) states: BTreeMap<String, Vec<StateChange>>,
    /// How many of those are trees and nodes of trees.
    pub(super) tree_rows: usize,
    /// The last verdict of each fault.
    pub(super) faults: BTreeMap<FaultNumber, Fault>,
    /// Verdicts of faults for which there is no room.
    pub(super) verdicts_left_out: u64,
    /// Everything else that happened once.
    pub(super) incidents: Vec<Incident>,
    /// Cycles that took too long, by executor.
    pub(super) overruns: BTreeMap<String, u64>,
    /// Where the robot was, by what a component recorded: time and metres.
    pub(super) path: Vec<(u64, [f64; 2])>,
    /// Whose path that is.
    pub(super) path_topic: String,
    /// What the run came to, if a summary is given.
    pub(super) summary: Option<Summary>,
    /// A picture of the drive as `data:` address.
    pub(super) picture: Option<String>,
    /// Whether ports were recorded.
    pub(super) recorded: bool,
}

/// A change of a component's life-cycle state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct StateChange {
    pub(super) t_ns: u64,
    pub(super) from: String,
    pub(super) to: String,
    pub(super) incarnation: u32,
}

/// Something that happened once and is no verdict.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Incident {
    pub(super) t_ns: u64,
    /// `injection`, `container_restarted` and the like.
    pub(super) kind: String,
    /// In words.
    pub(super) text: String,
}

/// A fault and what became of it.
#[derive(Debug, Default)]
pub(super) struct Fault {
    /// The last verdict.
    pub(super) verdict: Verdict,
    /// When it was over, if it ever was.
    pub(super) healed_ns: Option<u64>,
    /// What a recording has of its evidence.
    pub(super) signal: Option<Signal>,
}

impl Fault {
    /// Whether it was over, or at least handled: what [`Self::end_ns`] is the time of.
    pub(super) fn end_word(&self) -> &'static str {
        if self.healed_ns.is_some() {
            "healed"
        } else {
            "handled"
        }
    }

    /// When the fault was over, or at least all was done about it, as far as is known.
    pub(super) fn end_ns(&self) -> Option<u64> {
        let Verdict {
            confirmed_ns,
            decision_us,
            handling_us,
            ..
        } = &self.verdict;
        let handled = handling_us.map(|it| it.saturating_add(*decision_us).saturating_mul(1000));
        let handled = handled.map(|it| confirmed_ns.saturating_add(it));
        self.healed_ns.or(handled)
    }
}

/// A verdict as files have it. What a file does not say is empty.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub(super) struct Verdict {
    pub(super) id: u64,
    pub(super) state: String,
    pub(super) kind: String,
    pub(super) component: String,
    pub(super) incarnation: u32,
    pub(super) node: String,
    pub(super) rule: Option<String>,
    pub(super) evidence: Value,
    pub(super) symptoms: u32,
    pub(super) first_symptom_ns: u64,
    pub(super) confirmed_ns: u64,
    pub(super) cause: Value,
    pub(super) severity: String,
    pub(super) plan: Vec<String>,
    pub(super) actions: Vec<Action>,
    pub(super) detection_us: u64,
    pub(super) decision_us: u64,
    pub(super) handling_us: Option<u64>,
}

/// One action of a verdict.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(default)]
pub(super) struct Action {
    pub(super) action: String,
    pub(super) outcome: String,
    pub(super) note: String,
}

/// A recorded quantity around a fault.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Signal {
    /// What it is: `left_sonar, range, distance`.
    pub(super) name: String,
    /// Its values: time in nanoseconds of the run's clock; what is no number is NaN.
    pub(super) samples: Vec<(u64, f64)>,
    /// Samples that were not kept, because there are too many.
    pub(super) left_out: u64,
}

/// A summary as `steadfast run --summary` writes it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(super) struct Summary {
    pub(super) applications: BTreeMap<String, ApplicationSummary>,
    pub(super) components: BTreeMap<String, ComponentSummary>,
    pub(super) restarts: u32,
    pub(super) robot: Option<RobotSummary>,
}

/// One application of a summary.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(super) struct ApplicationSummary {
    pub(super) state: String,
}

/// One component of a summary.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(super) struct ComponentSummary {
    pub(super) state: String,
    pub(super) incarnation: u32,
    pub(super) cycles: u64,
    pub(super) overruns: u64,
    pub(super) tier: String,
}

/// The robot of a summary.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub(super) struct RobotSummary {
    pub(super) reached: bool,
    pub(super) time_s: Option<f64>,
    pub(super) distance_to_target_m: f64,
    pub(super) collisions: u64,
    pub(super) least_clearance_m: f64,
    pub(super) path_length_m: f64,
}
