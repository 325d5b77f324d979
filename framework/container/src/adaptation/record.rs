//! What goes on record of a decision: all candidates with their numbers, why each was rejected, how
//! long each phase took.

use std::time::Duration;

use serde::Serialize;
use system_model::task::{Placement, TaskSpecification};
use task_adaptation::{GenerationFailure, Judged, Outcome, Phases, Rejection, Trigger, Verdict};

/// The record of one decision.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdaptationRecord {
    /// Name of the task.
    pub task: String,
    /// How it ended, in words.
    pub text: String,
    /// Number of the decision, from 1.
    pub decision: u64,
    /// `evaluated`, `requested` or `lost`.
    pub trigger: &'static str,
    /// `changed`, `kept`, `no_candidate`, `overtaken` or `not_generated`.
    pub outcome: &'static str,
    /// Number of the candidate that runs now, if it is one of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<usize>,
    /// How many combinations there are; approximate beyond 2^64.
    pub combinations: f64,
    /// How many groups there are.
    pub groups: f64,
    /// All candidates.
    pub candidates: Vec<CandidateRecord>,
    /// Number of the candidate that comes nearest where none is feasible, and what it lacks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<(usize, String)>,
    /// Essential components that no robot has.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lacking: Vec<String>,
    /// Why candidates could not be generated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// How long each phase took.
    pub phases: PhaseRecord,
}

/// One candidate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateRecord {
    /// From 1.
    pub number: usize,
    /// `robot:component`, in the order of the task.
    pub components: Vec<String>,
    /// Node hops.
    pub hops: u32,
    /// P_F of Equation (3).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_f: Option<f64>,
    /// P_NF of Equation (4).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_nf: Option<f64>,
    /// P_T of Equation (8).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_t: Option<f64>,
    /// Whether it could be taken.
    pub feasible: bool,
    /// Why it was not taken; empty for the chosen one.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub rejected_because: String,
}

/// How long each phase took, in microseconds of the container's clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PhaseRecord {
    /// From the first bad evaluation until enough were bad.
    pub monitoring_us: u64,
    /// Until the candidates were there.
    pub synthesis_us: u64,
    /// Until all estimates were there.
    pub estimation_us: u64,
    /// Until the change was done or had failed.
    pub reconfiguration_us: u64,
}

impl AdaptationRecord {
    /// The record of a verdict.
    pub fn of(task: &TaskSpecification, verdict: &Verdict) -> Self {
        let nearest = verdict.nearest.as_ref();
        let lacking = verdict.lacking.iter();
        let mut record = Self {
            task: task.name.clone(),
            text: String::new(),
            decision: verdict.decision,
            trigger: match verdict.trigger {
                Trigger::Evaluated { .. } => "evaluated",
                Trigger::Requested => "requested",
                Trigger::Lost(_) => "lost",
            },
            outcome: match verdict.outcome {
                Outcome::Changed(_) => "changed",
                Outcome::Kept(_) => "kept",
                Outcome::NoCandidate => "no_candidate",
                Outcome::Overtaken => "overtaken",
                Outcome::NotGenerated(_) => "not_generated",
            },
            chosen: match verdict.outcome {
                Outcome::Changed(number) | Outcome::Kept(number) => Some(number),
                _ => None,
            },
            combinations: verdict.combinations as f64,
            groups: verdict.groups as f64,
            candidates: (verdict.candidates.iter())
                .map(|judged| CandidateRecord::of(task, judged))
                .collect(),
            nearest: nearest.map(|nearest| (nearest.number, words(task, &nearest.lacks))),
            lacking: lacking
                .map(|it| task.components[*it].name.clone())
                .collect(),
            failure: match &verdict.outcome {
                Outcome::NotGenerated(GenerationFailure::Refused(error)) => Some(error.to_string()),
                Outcome::NotGenerated(GenerationFailure::Silent(time)) => {
                    Some(format!("there were no candidates after {time:?}"))
                }
                _ => None,
            },
            phases: PhaseRecord::of(verdict.phases),
        };
        record.text = format!("the task {} {}", record.task, record.in_words());
        record
    }
}

impl AdaptationRecord {
    fn in_words(&self) -> String {
        let chosen = self.chosen.and_then(|number| {
            let mut candidates = self.candidates.iter();
            candidates.find(|it| it.number == number)
        });
        let components = chosen.map_or_else(String::new, |it| it.components.join(" | "));
        match (self.outcome, &self.nearest) {
            ("changed", _) => format!("is done by {components} from now on"),
            ("kept", _) => format!("stays with {components}"),
            ("no_candidate", Some((number, lacks))) => {
                format!("cannot be done otherwise; candidate {number} is nearest: {lacks}")
            }
            ("no_candidate", None) if !self.lacking.is_empty() => {
                format!("cannot be done: no robot has {}", self.lacking.join(", "))
            }
            ("no_candidate", None) => "cannot be done otherwise".to_owned(),
            ("overtaken", _) => "is decided upon anew: robots have changed".to_owned(),
            _ => format!(
                "cannot be decided upon: {}",
                self.failure.as_deref().unwrap_or_default()
            ),
        }
    }
}

impl CandidateRecord {
    fn of(task: &TaskSpecification, judged: &Judged) -> Self {
        let name = |placement: &Placement| task.placement_name(*placement);
        let quality = judged.quality;
        Self {
            number: judged.number,
            components: judged.candidate.placements.iter().map(name).collect(),
            hops: judged.candidate.hops,
            p_f: quality.map(|it| it.functional),
            p_nf: quality.map(|it| it.non_functional),
            p_t: quality.map(|it| it.total),
            feasible: judged.is_feasible,
            rejected_because: words(task, &judged.rejections),
        }
    }
}

impl PhaseRecord {
    fn of(phases: Phases) -> Self {
        let us = |time: Duration| u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        Self {
            monitoring_us: us(phases.monitoring),
            synthesis_us: us(phases.synthesis),
            estimation_us: us(phases.estimation),
            reconfiguration_us: us(phases.reconfiguration),
        }
    }
}

fn words(task: &TaskSpecification, rejections: &[Rejection]) -> String {
    let words = rejections.iter().map(|it| it.in_words(task));
    words.collect::<Vec<_>>().join("; ")
}
