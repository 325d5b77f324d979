//! What is on record of a fault: what was seen, why it was judged so, what was done, how long each
//! phase took.

use serde::Serialize;
use system_model::rules::ComponentSeverity;

use crate::evidence::Evidence;

/// Numbers faults from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(transparent)]
pub struct FaultId(pub u64);

/// Where a fault stands in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum FaultState {
    /// Symptoms have been seen, not yet enough.
    Prefailed,
    /// It is a fault.
    Confirmed,
    /// The symptoms are gone, or the component was recovered.
    Healed,
    /// It is over: history.
    Cleared,
}

/// Why there is the fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// By itself.
    Root,
    /// Because of this other fault.
    ConsequenceOf(FaultId),
}

/// How much it matters, for files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Recorded only.
    Ignore,
    /// Recovered in place.
    Reset,
    /// The component is stopped.
    Stop,
    /// Emergency stop.
    Emergency,
}

impl From<ComponentSeverity> for Severity {
    fn from(severity: ComponentSeverity) -> Self {
        match severity {
            ComponentSeverity::Ignore => Self::Ignore,
            ComponentSeverity::Reset => Self::Reset,
            ComponentSeverity::Stop => Self::Stop,
            ComponentSeverity::Emergency => Self::Emergency,
        }
    }
}

/// The record of one fault. Written when it is confirmed and whenever something about it changes;
/// the last one counts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Its number.
    pub id: FaultId,
    /// Where it stands.
    pub state: FaultState,
    /// Kind of fault, as in `FaultKind::name`.
    pub kind: &'static str,
    /// Instance name.
    pub component: String,
    /// Incarnation that showed the first symptom.
    pub incarnation: u32,
    /// Node of the component; empty for the local one.
    pub node: String,
    /// `file:line:column` of the rule that it was judged by; none for a default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rule: Option<String>,
    /// What the last symptom was.
    pub evidence: Evidence,
    /// How many symptoms there were.
    pub symptoms: u32,
    /// When the first symptom was, in nanoseconds of the application's clock.
    pub first_symptom_ns: u64,
    /// When it became a fault.
    pub confirmed_ns: u64,
    /// Root cause, or whose consequence.
    pub cause: Cause,
    /// How much it matters.
    pub severity: Severity,
    /// What is to be done, in words, in order; it grows when the ladder is climbed.
    pub plan: Vec<String>,
    /// What was done so far.
    pub actions: Vec<ActionRecord>,
    /// From the first symptom to the fault, in microseconds.
    pub detection_us: u64,
    /// From there until the plan was made.
    pub decision_us: u64,
    /// From there until the last action had ended and the component worked; none while that is
    /// under way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub handling_us: Option<u64>,
}

/// One action of a verdict.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ActionRecord {
    /// What was done, in words: `reset path_planner`, `replace obstacle_avoidance by
    /// obstacle_avoidance_simple`, `stop camera`, `emergency stop`.
    pub action: String,
    /// `under_way`, `done`, `failed`, `overdue` or `abandoned`.
    pub outcome: &'static str,
    /// Why, or what is to be known of it.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}
