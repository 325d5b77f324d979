//! Helpers that watch several ports at once: process models and voters.

use std::time::Duration;

use super::detection::Judgement;
use crate::profile::Located;

/// A data port that a rule names, and what of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RulePort {
    /// Index of the component.
    pub component: usize,
    /// Name of the port.
    pub port: String,
    /// Path of the field; none means all of the datum.
    pub field: Option<String>,
    /// Name of the port's data type as the profile declares it.
    pub data_type: String,
}

/// A process-model monitor: the model gets the inputs, and its outputs are compared with those of
/// the components.
#[derive(Debug, Clone, PartialEq)]
pub struct MonitorRule {
    /// Name of the monitor.
    pub name: String,
    /// How it decides.
    pub rule: Located<ProcessModelRule>,
    /// What goes into the model.
    pub inputs: Vec<RulePort>,
    /// What is compared with what comes out of the model.
    pub outputs: Vec<RulePort>,
}

/// `process_model`, without its ports.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessModelRule {
    /// The reference model: a file, or the name of a component; looked up when it is loaded.
    pub model: String,
    /// Residuals are filtered over this time.
    pub window: Duration,
    /// What the decision rule compares with.
    pub threshold: f64,
    /// The decision rule.
    pub method: DecisionRule,
    /// Parameters of the model in document order.
    pub parameters: Vec<(String, f64)>,
    /// How symptoms become a fault.
    pub judgement: Judgement,
}

/// How residuals become a symptom.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum DecisionRule {
    /// The mean of the residuals over the window exceeds the threshold. The default: the paper's.
    #[default]
    Window,
    /// The cumulated residuals beyond a drift exceed the threshold.
    Cusum {
        /// What is taken off each residual; none leaves the choice to the detector.
        drift: Option<f64>,
    },
    /// The squared innovations of a Kalman filter, in units of their covariance and summed over the
    /// window, exceed the threshold.
    ChiSquare,
}

/// A voter between several sources and one input.
#[derive(Debug, Clone, PartialEq)]
pub struct VotingSpecification {
    /// Name of the voter.
    pub name: String,
    /// How it decides.
    pub rule: Located<VotingRule>,
    /// The sources, output data ports of one type.
    pub sources: Vec<VotingSource>,
    /// The input data port that gets the voted value.
    pub output: RulePort,
}

/// One source of a voter.
#[derive(Debug, Clone, PartialEq)]
pub struct VotingSource {
    /// Its port.
    pub port: RulePort,
    /// How much it counts; 1 where nothing is said.
    pub weight: f64,
}

/// `voting`, without its ports.
#[derive(Debug, Clone, PartialEq)]
pub struct VotingRule {
    /// Number of sources.
    pub of: usize,
    /// How the voted value is found.
    pub method: VotingMethod,
    /// A source that differs by more from the voted value disagrees.
    pub tolerance: f64,
    /// How symptoms of a source become its fault.
    pub judgement: Judgement,
}

/// How a voted value is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum VotingMethod {
    /// The middle one. The default: it is a value that a source really gave.
    #[default]
    Median,
    /// The mean of the largest group that agrees.
    Majority,
    /// The mean by weight.
    Weighted,
}
