//! Process models: what a process does is compared with what its model says it should do (section
//! 3.2.3 of Ahn et al., 2012).
//!
//! Two ways to a residual, three ways to decide:
//!
//! * `window` and `cusum` judge measured minus simulated outputs. The simulation is never told what
//!   was measured, so it cannot get used to a fault.
//! * `chi_square` judges the innovations of a Kalman filter, measured minus predicted outputs. The
//!   filter corrects the model's state and so needs less of the model; it would also learn a fault.
//!   So it does not learn from a measurement that is an outlier, nor while it suspects a fault.
//!
//! A gap in the data is bridged by the model; a long one begins anew. Where the process is not where
//! the model begins, nothing is judged until the filter has found its state.

mod decision;
mod discrete;
mod input_map;
mod kalman;
mod monitor;
mod sampling;
mod slopes;
#[cfg(test)]
mod tests;

pub use decision::{MAXIMUM_WINDOW_SAMPLES, ResidualMonitor};
pub use discrete::DiscreteModel;
pub use input_map::InputMap;
pub use kalman::KalmanFilter;
pub use monitor::Monitor;

/// Why a model cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ModelError {
    /// The matrices do not fit each other.
    #[error("the matrices of the model do not fit each other")]
    Shape,
    /// A number is none, or the model grows without bound within a period.
    #[error("the model has no finite discrete form: its period is too long or a number too large")]
    NotFinite,
    /// The noise is no covariance, or the filter does not settle: a state that grows is not seen in
    /// any output.
    #[error(
        "no Kalman filter settles: a state that does not decay is seen in no output, or the \
         measurement noise is not positive"
    )]
    NoFilter,
    /// The window of the rule is too long.
    #[error("the window has more than {MAXIMUM_WINDOW_SAMPLES} periods of the model")]
    Window,
    /// The method asks how the residuals scatter, and of a reference-model component nobody knows.
    #[error(
        "the outputs of a component have no covariance: write a model file, or cusum with a drift"
    )]
    NoCovariance,
    /// The rule sets a parameter that no model has, or to a value that it cannot have.
    #[error(
        "`{0}` is no parameter of a model; there are input_delay_ms and input_jitter_ms (from 0), \
         process_noise_scale and measurement_noise_scale"
    )]
    Parameter(String),
}

/// Figures for the evidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Index of the output that is farthest off.
    pub output: usize,
    /// What was measured minus what the model says, in the unit of that output, now.
    pub residual: f64,
    /// What the decision rule made of all residuals of the window.
    pub statistic: f64,
    /// What it is compared with.
    pub threshold: f64,
}
