//! What the decider is told and what it asks for.

use system_model::task::TaskSpecification;

use crate::estimate::Answer;
use crate::generator::{Candidate, Generation, GenerationError};
use crate::verdict::Verdict;

/// What the decider is told.
#[derive(Debug, Clone, PartialEq)]
pub enum Observation {
    /// What the evaluators of what runs say, one performance for each placement.
    Evaluated(Answer),
    /// A rule or a person asks for a decision.
    Requested,
    /// Robots, instances or resources have changed. The lists of components, robots and resources
    /// have the same members in the same order; what a lost robot had is empty or 0.
    TaskChanged(Box<TaskSpecification>),
    /// The candidates that were asked for, of [`generate`](crate::generate).
    Synthesised {
        /// Of which decision.
        decision: u64,
        /// What came of it.
        result: Result<Generation, GenerationError>,
    },
    /// What a candidate's estimators say.
    Estimated {
        /// Of which decision.
        decision: u64,
        /// Which candidate.
        number: usize,
        /// What they say.
        answer: Answer,
    },
    /// A candidate runs.
    Reconfigured {
        /// Of which decision.
        decision: u64,
        /// Which candidate.
        number: usize,
    },
    /// A candidate could not be brought about; what ran goes on.
    ReconfigurationFailed {
        /// Of which decision.
        decision: u64,
        /// Which candidate.
        number: usize,
        /// Why.
        reason: String,
    },
    /// Nothing but that time has passed.
    TimePassed,
}

/// What the shell is to do.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Generate candidates for [`Decider::task`](crate::Decider::task), [`Decider::running`](crate::Decider::running) being what runs.
    Synthesise {
        /// For which decision.
        decision: u64,
    },
    /// Let a candidate's estimators run for one cycle.
    Estimate {
        /// For which decision.
        decision: u64,
        /// Number of the candidate.
        number: usize,
        /// The candidate.
        candidate: Candidate,
    },
    /// Let a candidate run instead of what runs.
    Reconfigure {
        /// For which decision.
        decision: u64,
        /// Number of the candidate.
        number: usize,
        /// The candidate.
        candidate: Candidate,
    },
    /// Give a change up that was not done in time, and go on with what ran. Its end is not reported.
    Abandon {
        /// Of which decision.
        decision: u64,
        /// Number of the candidate.
        number: usize,
    },
    /// Put a decision on record; it has ended.
    Decided(Box<Verdict>),
}
