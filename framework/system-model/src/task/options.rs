//! What is preferred, and how candidates are generated and decided upon.

use std::time::Duration;

/// Weights and thresholds of Definition 6; β_j are in [`TaskResource::weight`](super::TaskResource::weight).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QualityPreferences {
    /// α of Equation (3), above 0, at most 1.
    pub functional_weight: f64,
    /// P_F_th of Equation (6), 0 or more.
    pub functional_threshold: f64,
    /// P_NF_th of Equation (7), 0 or more.
    pub non_functional_threshold: f64,
}

/// Along what node hops are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HopCount {
    /// Along all components in use.
    Whole,
    /// Along the essential components; others are put in afterwards, the first instance first. So
    /// the paper's list of candidates was made.
    Essential,
}

impl HopCount {
    /// The word in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::Essential => "essential",
        }
    }
}

/// How candidates are generated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GenerationOptions {
    /// Along what node hops are counted.
    pub hops: HopCount,
    /// Whether the group of what runs is judged with the others.
    pub judges_running: bool,
    /// No more candidates than this, those with the fewest hops first.
    pub limit: usize,
}

/// When and how it is decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecisionOptions {
    /// So many evaluations in a row have to be bad.
    pub confirm: u32,
    /// Between two changes passes at least this time.
    pub dwell: Duration,
    /// What runs and is feasible is given up only for a quality (Equation (8)) that is larger by this
    /// part of its own.
    pub hysteresis: f64,
    /// An estimator that has not answered by then is no candidate's.
    pub estimation_deadline: Duration,
    /// A change that is not done by then has failed.
    pub reconfiguration_deadline: Duration,
    /// How often what runs is evaluated.
    pub evaluation_period: Duration,
}

/// No more candidates than this where a file says nothing: a person reads tens, an estimator that
/// takes a millisecond for each is done within a second.
pub const DEFAULT_CANDIDATE_LIMIT: usize = 1000;

impl Default for GenerationOptions {
    fn default() -> Self {
        Self {
            hops: HopCount::Whole,
            judges_running: true,
            limit: DEFAULT_CANDIDATE_LIMIT,
        }
    }
}

impl Default for DecisionOptions {
    /// Three bad evaluations are no outlier; ten seconds show whether a change has helped; a
    /// twentieth is within what estimates err; estimators run for one cycle, and libraries load in
    /// less than a second.
    fn default() -> Self {
        Self {
            confirm: 3,
            dwell: Duration::from_secs(10),
            hysteresis: 0.05,
            estimation_deadline: Duration::from_millis(500),
            reconfiguration_deadline: Duration::from_secs(2),
            evaluation_period: super::DEFAULT_EVALUATION_PERIOD,
        }
    }
}
