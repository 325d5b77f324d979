//! Models of processes for fault detection: linear state space with noise.

use std::time::Duration;

/// A reference model: what the outputs of a process are, given its inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessModel {
    /// The model's name.
    pub name: String,
    /// The dynamics.
    pub state_space: StateSpace,
    /// Covariance of what disturbs the states: of a discrete model in one period, of a continuous
    /// one its density (per second). Symmetric, states x states.
    pub process_noise: Matrix,
    /// Covariance of the noise of one measurement. Positive definite, outputs x outputs.
    pub measurement_noise: Matrix,
    /// Between an input as it is observed and its effect; whole periods, else rounded.
    pub input_delay: Duration,
    /// An input may act so much earlier or later: periods of executors and lines are not in step. A
    /// residual is excused as far as its output moves in this time.
    pub input_jitter: Duration,
    /// How the inputs are got from the data of a port, one for each input; empty where each input
    /// is a number of its own port.
    pub inputs: Vec<ModelInput>,
}

/// x' = A x + B u (continuous) or x(k+1) = A x(k) + B u(k) (discrete); y = C x + D u.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// What x' and the period mean.
    pub kind: StateSpaceKind,
    /// Time between two samples. A continuous model is made discrete with it, inputs held between
    /// samples.
    pub period: Duration,
    /// States x states.
    pub a: Matrix,
    /// States x inputs.
    pub b: Matrix,
    /// Outputs x states.
    pub c: Matrix,
    /// Outputs x inputs.
    pub d: Matrix,
    /// The state at the beginning, when nothing has come in.
    pub initial: Vec<f64>,
}

/// How the dynamics are written down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StateSpaceKind {
    /// As differential equation, in seconds.
    Continuous,
    /// As difference equation, from sample to sample.
    Discrete,
}

/// A matrix, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// All elements of the first row, then of the next.
    pub elements: Vec<f64>,
}

impl Matrix {
    /// Nothing but zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            elements: vec![0.0; rows * columns],
        }
    }
}

/// One input of a model, made of the fields of a datum: the first case whose condition holds
/// counts; if none does, the input is 0.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelInput {
    /// Name, for people.
    pub name: String,
    /// In document order.
    pub cases: Vec<InputCase>,
}

/// One case: a sum of scaled fields.
#[derive(Debug, Clone, PartialEq)]
pub struct InputCase {
    /// When it counts; none means always.
    pub condition: Option<InputCondition>,
    /// What is added up.
    pub terms: Vec<InputTerm>,
    /// And this.
    pub offset: f64,
}

/// A field has a certain value.
#[derive(Debug, Clone, PartialEq)]
pub struct InputCondition {
    /// Path of the field.
    pub field: String,
    /// The value, exactly.
    pub equals: f64,
}

/// A field times a factor.
#[derive(Debug, Clone, PartialEq)]
pub struct InputTerm {
    /// Path of the field.
    pub field: String,
    /// The factor.
    pub scale: f64,
}
