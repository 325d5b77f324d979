//! What is on record of a decision: all candidates with their numbers, why each was rejected, how
//! long each phase took.

use std::time::Duration;

use system_model::task::{ComponentIndex, Placement};

use crate::estimate::Implausible;
use crate::generator::{Candidate, GenerationError};
use crate::quality::Quality;
use crate::resources::Shortage;

/// A candidate after it has been judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// From 1, in the order in which candidates were generated.
    pub number: usize,
    /// The candidate.
    pub candidate: Candidate,
    /// P_F, P_NF and P_T, if there was an answer to reckon with.
    pub quality: Option<Quality>,
    /// Whether it could be taken.
    pub is_feasible: bool,
    /// Why it was not taken; empty for the chosen one.
    pub rejections: Vec<Rejection>,
}

/// Why a candidate was not taken.
#[derive(Debug, Clone, PartialEq)]
pub enum Rejection {
    /// Robots have less than it needs.
    NoRoom(Vec<Shortage>),
    /// Robots have less than it needs, and whether another placement of its group has room was not
    /// found out within bounded time.
    RoomUnknown(Vec<Shortage>),
    /// P_F does not exceed its threshold, Equation (6).
    Functional {
        /// P_F.
        performance: f64,
        /// Components whose own error has reached their threshold, with that error.
        over: Vec<(ComponentIndex, f64)>,
    },
    /// P_NF does not exceed its threshold, Equation (7).
    NonFunctional(f64),
    /// A number cannot be one.
    Implausible {
        /// Whose; nobody's, if there is an answer without a question.
        placement: Option<Placement>,
        /// What is wrong with it.
        what: Implausible,
    },
    /// An estimator crashed; how.
    Crashed(String),
    /// An estimator had not answered after this time.
    Silent(Duration),
    /// It was chosen, and could not be brought about; why.
    ChangeFailed(String),
    /// A robot has lost one of its instances since it was generated.
    Lost,
    /// It is feasible, and another one was chosen.
    NotBetter {
        /// Number of the chosen one.
        chosen: usize,
        /// P_T of the chosen one.
        total: f64,
    },
    /// It is better than what runs, but by less than the hysteresis.
    NotBetterByEnough {
        /// Number of what runs.
        kept: usize,
        /// P_T of what runs.
        total: f64,
    },
}

/// Why a decision was begun.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trigger {
    /// So many evaluations in a row were bad.
    Evaluated {
        /// How many.
        bad_evaluations: u32,
    },
    /// Somebody asked, a rule or a person.
    Requested,
    /// What runs has lost these.
    Lost(Vec<Placement>),
}

/// How a decision ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// The candidate of this number runs.
    Changed(usize),
    /// What runs is the candidate of this number, and none is better by enough.
    Kept(usize),
    /// No candidate is feasible, or none could be brought about; what ran goes on.
    NoCandidate,
    /// Robots or resources changed before there was a choice; the next decision is made with them.
    Overtaken,
    /// Candidates could not be generated.
    NotGenerated(GenerationFailure),
}

/// Why there are no candidates to judge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GenerationFailure {
    /// The generator says so.
    Refused(GenerationError),
    /// There was no answer after this time.
    Silent(Duration),
}

/// What comes nearest where no candidate is feasible.
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// The candidate's number.
    pub number: usize,
    /// What it lacks.
    pub lacks: Vec<Rejection>,
}

/// How long each phase took, by the times of the observations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Phases {
    /// From the first bad evaluation until enough were bad.
    pub monitoring: Duration,
    /// Until the candidates were there.
    pub synthesis: Duration,
    /// Until all estimates were there, or their deadline.
    pub estimation: Duration,
    /// Until the change was done or had failed, all attempts together.
    pub reconfiguration: Duration,
}

/// One decision from its trigger to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Number of the decision, from 1.
    pub decision: u64,
    /// Why it was begun.
    pub trigger: Trigger,
    /// Number of combinations; the largest number if there are more than that.
    pub combinations: u128,
    /// Number of groups.
    pub groups: u128,
    /// Groups of which there is no candidate.
    pub left_out: u128,
    /// Essential components that no robot has.
    pub lacking: Vec<ComponentIndex>,
    /// All candidates.
    pub candidates: Vec<Judged>,
    /// What comes nearest, if none is feasible.
    pub nearest: Option<Nearest>,
    /// How it ended.
    pub outcome: Outcome,
    /// How long it took.
    pub phases: Phases,
}

impl Verdict {
    /// The record of a decision that begins.
    pub(crate) fn begun(decision: u64, trigger: Trigger, monitoring: Duration) -> Self {
        Self {
            decision,
            trigger,
            combinations: 0,
            groups: 0,
            left_out: 0,
            lacking: Vec::new(),
            candidates: Vec::new(),
            nearest: None,
            outcome: Outcome::NoCandidate,
            phases: Phases {
                monitoring,
                ..Phases::default()
            },
        }
    }
}

impl Judged {
    /// P_T; nothing where there are no numbers.
    pub fn total(&self) -> f64 {
        self.quality.map_or(0.0, |quality| quality.total)
    }
}

impl Candidate {
    /// Whether it is just these placements, in whatever order.
    pub fn is_made_of(&self, placements: &[Placement]) -> bool {
        self.placements.len() == placements.len()
            && placements.iter().all(|it| self.placements.contains(it))
    }
}
