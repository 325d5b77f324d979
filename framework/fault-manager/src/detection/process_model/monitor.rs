//! A process and its model, side by side.

use std::time::Duration;

use nalgebra::{DVector, Schur};
use system_model::process_model::ProcessModel;
use system_model::rules::{DecisionRule, ProcessModelRule};

use super::decision::{Judge, bounded};
use super::sampling::{Sample, SampleClock};
use super::slopes::Slopes;
use super::{DiscreteModel, KalmanFilter, ModelError, Residual};
use crate::detection::Finding;

/// A first output this many standard deviations off the model's shows that the process is not where
/// the model begins.
const ELSEWHERE_DEVIATIONS: f64 = 5.0;
/// Quantile of the normal distribution for an outlier of one in a thousand.
const OUTLIER_QUANTILE: f64 = 3.09;

/// Compares the outputs of a process with those of its model.
#[derive(Debug, Clone)]
pub struct Monitor {
    model: DiscreteModel,
    filter: KalmanFilter,
    judge: Judge,
    clock: SampleClock,
    /// Whether the judged residuals are innovations.
    is_filtering: bool,
    /// A normalised square above this is an outlier.
    outlier: f64,
    /// Outliers after each other that the filter does not learn from; without a bound where the
    /// model's states decay and so come right by themselves.
    held_maximum: usize,
    held: usize,
    /// Samples before the next judgement.
    settling: u32,
    state: DVector<f64>,
    /// The inputs of the last samples, the one that acts now first.
    delayed: Vec<DVector<f64>>,
    slopes: Slopes,
    scratch: Scratch,
}

/// Room for the products of a step.
#[derive(Debug, Clone)]
struct Scratch {
    state: DVector<f64>,
    residual: DVector<f64>,
    output: DVector<f64>,
}

impl Monitor {
    /// A monitor by a rule. Its `parameter` elements change the model: `input_delay_ms`,
    /// `input_jitter_ms`, `process_noise_scale`, `measurement_noise_scale`.
    ///
    /// # Errors
    /// When the model has no discrete form or no filter, the window is too long, or there is no such
    /// parameter.
    pub fn new(model: &ProcessModel, rule: &ProcessModelRule) -> Result<Self, ModelError> {
        let model = DiscreteModel::new(&adjusted(model, rule)?)?;
        let filter = KalmanFilter::new(&model)?;
        let (states, outputs) = (model.a.nrows(), model.outputs());
        let deviations = model.residual_variances().map(f64::sqrt);
        let judge = Judge::new(rule, outputs, model.period, Some(deviations.as_slice()))?;
        let decays = decays(&model);
        Ok(Self {
            is_filtering: rule.method == DecisionRule::ChiSquare,
            outlier: chi_square_quantile(outputs, OUTLIER_QUANTILE),
            held_maximum: if decays { usize::MAX } else { judge.window() },
            held: 0,
            settling: 0,
            state: model.initial.clone(),
            delayed: vec![DVector::zeros(model.inputs()); model.delay + 1],
            scratch: Scratch {
                state: DVector::zeros(states),
                residual: DVector::zeros(outputs),
                output: DVector::zeros(outputs),
            },
            slopes: Slopes::new(outputs),
            clock: SampleClock::new(model.period),
            model,
            filter,
            judge,
        })
    }

    /// The newest inputs and outputs at this time. The first call whose numbers are all finite arms
    /// the monitor. Afterwards an input that is no number is taken as the last one, and nothing is
    /// said of a sample without finite outputs, of a second one within a period, while the filter
    /// looks for the state, and while more than half of the window is missing. Nothing at all is
    /// said where the numbers of inputs or outputs are not those of the model.
    pub fn step(
        &mut self,
        at: Duration,
        inputs: &[f64],
        outputs: &[f64],
    ) -> Option<Finding<Residual>> {
        if inputs.len() != self.model.inputs() || outputs.len() != self.model.outputs() {
            return None;
        }
        let measured = outputs.iter().all(|output| output.is_finite());
        let missing = match self.clock.tick(at) {
            Sample::Early => return None,
            Sample::First | Sample::LongGap => {
                return self.begin(at, inputs, outputs);
            }
            Sample::After(periods) => {
                self.advance(periods, inputs);
                periods - 1
            }
        };
        if !self.state.iter().all(|state| state.is_finite()) {
            self.reset();
            return None;
        }
        if !measured {
            return None;
        }
        self.compare(outputs);
        let square = self
            .filter
            .normalised_square(&self.scratch.residual, &mut self.scratch.output);
        if self.settling > 0 {
            self.settling -= 1;
            self.correct();
            return None;
        }
        let finding = self
            .judge
            .judge(missing, self.scratch.residual.as_slice(), square);
        if self.is_filtering {
            self.learn(square);
        }
        finding
    }

    /// What was measured minus what the model says, or the filter predicted, of each output.
    pub fn residuals(&self) -> &[f64] {
        self.scratch.residual.as_slice()
    }

    /// What the decision rule made of the residuals so far, to be compared with the threshold.
    pub fn statistic(&self) -> f64 {
        self.judge.statistic()
    }

    /// The discrete form of the model.
    pub fn model(&self) -> &DiscreteModel {
        &self.model
    }

    /// Begins anew with the next data, as after the process was reset.
    pub fn reset(&mut self) {
        self.clock.reset();
        self.judge.reset();
        self.state.copy_from(&self.model.initial);
        for input in &mut self.delayed {
            input.fill(0.0);
        }
        self.slopes.reset();
        (self.held, self.settling) = (0, 0);
    }

    #[cfg(test)]
    pub(super) fn filter_gain(&self) -> f64 {
        self.filter.gain[(0, 0)]
    }

    fn begin(
        &mut self,
        at: Duration,
        inputs: &[f64],
        outputs: &[f64],
    ) -> Option<Finding<Residual>> {
        self.reset();
        if !inputs.iter().chain(outputs).all(|value| value.is_finite()) {
            return None;
        }
        self.clock.tick(at);
        self.push_input(inputs);
        self.compare(outputs);
        let variances = self.filter.innovation_covariance.diagonal();
        let is_elsewhere = self
            .scratch
            .residual
            .iter()
            .zip(&variances)
            .any(|(residual, variance)| residual.abs() > ELSEWHERE_DEVIATIONS * variance.sqrt());
        if is_elsewhere {
            self.settling = self.filter.settling_samples;
            self.correct();
        }
        None
    }

    /// Moves the model on; inputs are held until the newest ones.
    fn advance(&mut self, periods: usize, inputs: &[f64]) {
        for period in 1..=periods {
            let next = &mut self.scratch.state;
            next.gemv(1.0, &self.model.a, &self.state, 0.0);
            next.gemv(1.0, &self.model.b, &self.delayed[0], 1.0);
            std::mem::swap(&mut self.state, next);
            self.push_input(if period == periods { inputs } else { &[] });
        }
    }

    /// Puts the newest inputs at the end of the delay; what is missing or no number stays as it was.
    fn push_input(&mut self, inputs: &[f64]) {
        self.delayed.rotate_left(1);
        let newest = self.delayed.len() - 1;
        let (older, newest) = self.delayed.split_at_mut(newest);
        if let Some(last) = older.last() {
            newest[0].copy_from(last);
        }
        for (own, input) in newest[0].iter_mut().zip(inputs) {
            if input.is_finite() {
                *own = *input;
            }
        }
    }

    /// Measured minus predicted outputs, less what jitter of the inputs explains.
    fn compare(&mut self, outputs: &[f64]) {
        let expected = &mut self.scratch.output;
        expected.gemv(1.0, &self.model.c, &self.state, 0.0);
        expected.gemv(1.0, &self.model.d, &self.delayed[0], 1.0);
        self.slopes.follow(expected);
        for (output, residual) in self.scratch.residual.iter_mut().enumerate() {
            let difference = bounded(outputs[output] - expected[output]);
            let excused = self.model.jitter * self.slopes.steepest(output);
            *residual = (difference.abs() - excused).max(0.0).copysign(difference);
        }
    }

    /// The filter learns from what is no outlier, as long as nothing is suspected.
    fn learn(&mut self, square: f64) {
        let is_held = square > self.outlier || self.judge.suspects();
        if is_held && self.held < self.held_maximum {
            self.held += 1;
            return;
        }
        self.held = 0;
        self.correct();
    }

    fn correct(&mut self) {
        self.state
            .gemv(1.0, &self.filter.gain, &self.scratch.residual, 1.0);
    }
}

/// Whether every state comes right by itself; a model whose poles are not found is not trusted.
fn decays(model: &DiscreteModel) -> bool {
    // Eigenvalues of a small matrix take a few iterations each.
    const ITERATIONS_MAXIMUM: usize = 10_000;
    let schur = Schur::try_new(model.a.clone(), f64::EPSILON, ITERATIONS_MAXIMUM);
    schur.is_some_and(|schur| {
        let poles = schur.complex_eigenvalues();
        poles.iter().all(|pole| pole.norm() < 1.0)
    })
}

/// The model with the parameters of the rule.
fn adjusted(model: &ProcessModel, rule: &ProcessModelRule) -> Result<ProcessModel, ModelError> {
    let mut model = model.clone();
    for (name, value) in &rule.parameters {
        let time = || {
            let time = Duration::try_from_secs_f64(value / 1000.0);
            time.map_err(|_| ModelError::Parameter(name.clone()))
        };
        let noise = match name.as_str() {
            "input_delay_ms" => {
                model.input_delay = time()?;
                continue;
            }
            "input_jitter_ms" => {
                model.input_jitter = time()?;
                continue;
            }
            "process_noise_scale" => &mut model.process_noise,
            "measurement_noise_scale" => &mut model.measurement_noise,
            _ => return Err(ModelError::Parameter(name.clone())),
        };
        for element in &mut noise.elements {
            *element *= value;
        }
    }
    Ok(model)
}

/// Wilson and Hilferty (1931): the cube root of chi-square is nearly normal.
fn chi_square_quantile(degrees: usize, normal_quantile: f64) -> f64 {
    let degrees = degrees as f64;
    let spread = 2.0 / (9.0 * degrees);
    degrees * (1.0 - spread + normal_quantile * spread.sqrt()).powi(3)
}
