//! From residuals to a symptom: the paper's window, CUSUM, chi-square.

use std::time::Duration;

use system_model::rules::{DecisionRule, ProcessModelRule};

use super::sampling::{Sample, SampleClock};
use super::{ModelError, Residual};
use crate::detection::Finding;

/// The window is added up for each sample; so many take about a microsecond. At 50 samples a second
/// it is 20 s: what is so slow is no fault that an emergency stop mends.
pub const MAXIMUM_WINDOW_SAMPLES: usize = 1000;

/// Judges residuals by one of the decision rules.
#[derive(Debug, Clone)]
pub(super) struct Judge {
    threshold: f64,
    method: Method,
    outputs: usize,
    window: usize,
    /// Of each output one window of residuals, of chi-square one of squares; NaN where none came.
    recent: Vec<f64>,
    position: usize,
    statistic: f64,
    worst: usize,
}

#[derive(Debug, Clone)]
enum Method {
    /// The mean over the window.
    Window,
    /// Sums of what the mean is above and below 0 by more than the drift, of each output
    /// (Page, 1954: Continuous inspection schemes).
    Cusum {
        drifts: Vec<f64>,
        above: Vec<f64>,
        below: Vec<f64>,
    },
    /// The sum of normalised squares over the window.
    ChiSquare,
}

impl Judge {
    /// `deviations` are the standard deviations that the residuals have by noise alone.
    pub(super) fn new(
        rule: &ProcessModelRule,
        outputs: usize,
        period: Duration,
        deviations: Option<&[f64]>,
    ) -> Result<Self, ModelError> {
        let samples = (rule.window.as_secs_f64() / period.as_secs_f64()).round();
        if samples > MAXIMUM_WINDOW_SAMPLES as f64 {
            return Err(ModelError::Window);
        }
        let window = (samples as usize).max(1);
        let method = match rule.method {
            DecisionRule::Window => Method::Window,
            DecisionRule::Cusum { drift } => Method::Cusum {
                drifts: match (drift, deviations) {
                    (Some(drift), _) => vec![drift; outputs],
                    // Half of the shift that shall be found, one standard deviation (Page, 1954).
                    (None, Some(deviations)) => deviations.iter().map(|one| one / 2.0).collect(),
                    (None, None) => return Err(ModelError::NoCovariance),
                },
                above: vec![0.0; outputs],
                below: vec![0.0; outputs],
            },
            DecisionRule::ChiSquare => Method::ChiSquare,
        };
        Ok(Self {
            threshold: rule.threshold,
            method,
            outputs,
            window,
            recent: vec![f64::NAN; window * outputs],
            position: 0,
            statistic: 0.0,
            worst: 0,
        })
    }

    pub(super) fn statistic(&self) -> f64 {
        self.statistic
    }

    pub(super) fn window(&self) -> usize {
        self.window
    }

    pub(super) fn suspects(&self) -> bool {
        self.statistic > self.threshold
    }

    pub(super) fn reset(&mut self) {
        self.recent.fill(f64::NAN);
        self.statistic = 0.0;
        if let Method::Cusum { above, below, .. } = &mut self.method {
            above.fill(0.0);
            below.fill(0.0);
        }
    }

    /// Takes the residuals of one sample after `missing` samples without any, and judges them;
    /// `square` is their normalised square, for chi-square. Nothing is said while more than half of
    /// the window is missing.
    pub(super) fn judge(
        &mut self,
        missing: usize,
        residuals: &[f64],
        square: f64,
    ) -> Option<Finding<Residual>> {
        for _ in 0..missing.min(self.window) {
            self.remember(|_| f64::NAN);
        }
        let is_square = matches!(self.method, Method::ChiSquare);
        self.remember(|output| match is_square {
            true if output == 0 => square,
            true => 0.0,
            false => residuals[output],
        });
        self.statistic = self.evaluate()?;
        if is_square {
            let size = |output: &usize| residuals[*output].abs();
            self.worst = (0..self.outputs)
                .max_by(|one, other| size(one).total_cmp(&size(other)))
                .unwrap_or_default();
        }
        Some(match self.suspects() {
            false => Finding::Passed,
            true => Finding::Violated(Residual {
                output: self.worst,
                residual: residuals[self.worst],
                statistic: self.statistic,
                threshold: self.threshold,
            }),
        })
    }

    fn remember(&mut self, value: impl Fn(usize) -> f64) {
        for output in 0..self.outputs {
            self.recent[output * self.window + self.position] = value(output);
        }
        self.position = (self.position + 1) % self.window;
    }

    /// The statistic of the output that is farthest off.
    fn evaluate(&mut self) -> Option<f64> {
        let mut largest = 0.0_f64;
        for output in 0..self.outputs {
            let window = &self.recent[output * self.window..][..self.window];
            let (sum, count) = sum_and_count(window);
            if 2 * count < self.window {
                return None;
            }
            let statistic = match &mut self.method {
                Method::Window => (sum / count as f64).abs(),
                Method::ChiSquare => sum,
                Method::Cusum {
                    drifts,
                    above,
                    below,
                } => {
                    let (mean, drift) = (sum / count as f64, drifts[output]);
                    above[output] = (above[output] + mean - drift).max(0.0);
                    below[output] = (below[output] - mean - drift).max(0.0);
                    // Twice the threshold is enough to be above it, and soon gone when all is well.
                    for cumulated in [&mut above[output], &mut below[output]] {
                        *cumulated = cumulated.min(2.0 * self.threshold);
                    }
                    above[output].max(below[output])
                }
            };
            if statistic > largest {
                (largest, self.worst) = (statistic, output);
            }
        }
        Some(largest)
    }
}

fn sum_and_count(window: &[f64]) -> (f64, usize) {
    let present = window.iter().filter(|value| !value.is_nan());
    present.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1))
}

/// Compares the outputs of a reference-model component with those of the process: `window` and
/// `cusum` without a model of our own.
#[derive(Debug, Clone)]
pub struct ResidualMonitor {
    judge: Judge,
    clock: SampleClock,
    residuals: Vec<f64>,
}

impl ResidualMonitor {
    /// For so many outputs, which come with this period. Without a model nobody knows how the
    /// residuals scatter, so `cusum` must be given its drift.
    ///
    /// # Errors
    /// When the method needs a covariance or the window is too long.
    pub fn new(
        rule: &ProcessModelRule,
        outputs: usize,
        period: Duration,
    ) -> Result<Self, ModelError> {
        if rule.method == DecisionRule::ChiSquare {
            return Err(ModelError::NoCovariance);
        }
        if outputs == 0 || period.is_zero() {
            return Err(ModelError::Shape);
        }
        Ok(Self {
            judge: Judge::new(rule, outputs, period, None)?,
            clock: SampleClock::new(period),
            residuals: vec![0.0; outputs],
        })
    }

    /// Compares one sample. Nothing is said of one without finite numbers, of a second one within a
    /// period, and while more than half of the window is missing.
    pub fn step(
        &mut self,
        at: Duration,
        expected: &[f64],
        measured: &[f64],
    ) -> Option<Finding<Residual>> {
        let finite = |values: &[f64]| {
            values.len() == self.residuals.len() && values.iter().all(|value| value.is_finite())
        };
        if !finite(expected) || !finite(measured) {
            return None;
        }
        let missing = match self.clock.tick(at) {
            Sample::Early => return None,
            Sample::First | Sample::LongGap => {
                self.judge.reset();
                0
            }
            Sample::After(periods) => periods - 1,
        };
        for (residual, (measured, expected)) in
            self.residuals.iter_mut().zip(measured.iter().zip(expected))
        {
            *residual = bounded(measured - expected);
        }
        self.judge.judge(missing, &self.residuals, 0.0)
    }

    /// What was measured minus what was expected of each output.
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// What the decision rule made of the residuals so far, to be compared with the threshold.
    pub fn statistic(&self) -> f64 {
        self.judge.statistic()
    }

    /// Forgets everything, as after the process was reset.
    pub fn reset(&mut self) {
        self.judge.reset();
        self.clock.reset();
    }
}

/// A residual whose sums and squares are still numbers.
pub(super) fn bounded(residual: f64) -> f64 {
    const LARGEST: f64 = 1e100;
    residual.clamp(-LARGEST, LARGEST)
}
