//! A Kalman filter in its steady state.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::{DiscreteModel, ModelError};

/// The Riccati equation is iterated so often at most; with 50 samples a second the slowest state of
/// a model that is of any use settles within this time, 200 s.
const ITERATIONS_MAXIMUM: u32 = 10_000;
/// Relative change from one iteration to the next that is none any more: well above rounding, which
/// never comes to rest, and well below what a gain means.
const CONVERGED: f64 = 1e-10;
/// The share of a wrong first state that is left when the filter is believed.
const SETTLED: f64 = 0.05;
/// No wait is longer, 20 s at 50 samples a second: a detector that never judges is none.
const SETTLING_MAXIMUM_SAMPLES: u32 = 1000;

/// The filter that long observation leads to: its gain is a constant, so that a step costs a few
/// products of a matrix and a vector.
#[derive(Debug, Clone)]
pub struct KalmanFilter {
    /// How a measured deviation corrects the state. States x outputs.
    pub gain: DMatrix<f64>,
    /// Covariance of the innovations. Outputs x outputs.
    pub innovation_covariance: DMatrix<f64>,
    /// Samples until a wrong first state is all but forgotten.
    pub settling_samples: u32,
    /// Inverse of the lower Cholesky factor of the covariance.
    whitening: DMatrix<f64>,
}

impl KalmanFilter {
    /// Iterates P = A P A' + Q, S = C P C' + R, K = P C' S^-1, P = (1 - K C) P (1 - K C)' + K R K'
    /// until nothing changes.
    ///
    /// # Errors
    /// When a state that grows is not seen in the outputs, or the noise is no covariance.
    pub fn new(model: &DiscreteModel) -> Result<Self, ModelError> {
        let states = model.a.nrows();
        let one = DMatrix::<f64>::identity(states, states);
        let mut corrected = DMatrix::<f64>::zeros(states, states);
        let mut filter = None;
        for _ in 0..ITERATIONS_MAXIMUM {
            let predicted = &model.a * &corrected * model.a.transpose() + &model.process_noise;
            let covariance = &model.c * &predicted * model.c.transpose() + &model.measurement_noise;
            let factor = Cholesky::new(covariance.clone()).ok_or(ModelError::NoFilter)?;
            let gain = factor.solve(&(&model.c * &predicted)).transpose();
            let rest = &one - &gain * &model.c;
            let next = &rest * predicted * rest.transpose()
                + &gain * &model.measurement_noise * gain.transpose();
            let change = (&next - &corrected).norm();
            let scale = next.norm();
            corrected = next;
            filter = Some((gain, covariance, factor));
            if !scale.is_finite() {
                return Err(ModelError::NoFilter);
            }
            if change <= CONVERGED * scale {
                break;
            }
        }
        let (gain, innovation_covariance, factor) = filter.ok_or(ModelError::NoFilter)?;
        let outputs = model.outputs();
        let whitening = factor
            .l()
            .solve_lower_triangular(&DMatrix::identity(outputs, outputs))
            .ok_or(ModelError::NoFilter)?;
        let error_dynamics = (one - &gain * &model.c) * &model.a;
        Ok(Self {
            gain,
            innovation_covariance,
            settling_samples: settling_samples(&error_dynamics),
            whitening,
        })
    }

    /// The normalised innovation squared, v' S^-1 v; `scratch` has one element for each output.
    pub fn normalised_square(&self, innovation: &DVector<f64>, scratch: &mut DVector<f64>) -> f64 {
        scratch.gemv(1.0, &self.whitening, innovation, 0.0);
        scratch.norm_squared()
    }
}

/// Samples until the powers of a matrix are small.
fn settling_samples(dynamics: &DMatrix<f64>) -> u32 {
    let mut power = dynamics.clone();
    let mut samples = 1;
    while power.norm() > SETTLED && samples < SETTLING_MAXIMUM_SAMPLES {
        power = &power * dynamics;
        samples += 1;
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::process_model::tests::{discrete_model, matrix};

    #[test]
    fn a_random_walk_has_its_closed_form() {
        // P = P - P^2/(P + R) + Q: P = (Q + sqrt(Q^2 + 4 Q R)) / 2; the golden ratio for Q = R = 1.
        for (q, r) in [(1.0_f64, 1.0_f64), (0.01, 4.0), (25.0, 0.5)] {
            let model = discrete_model(matrix(1, 1, &[1.0]), matrix(1, 1, &[0.0]), &[q], r);
            let filter = KalmanFilter::new(&model).expect("a filter");
            let predicted = (q + (q * q + 4.0 * q * r).sqrt()) / 2.0;
            let covariance = filter.innovation_covariance[(0, 0)];
            assert!((covariance - predicted - r).abs() < 1e-9 * covariance);
            assert!((filter.gain[(0, 0)] - predicted / (predicted + r)).abs() < 1e-9);
            let innovation = DVector::from_element(1, 3.0);
            let square = filter.normalised_square(&innovation, &mut DVector::zeros(1));
            assert!((square - 9.0 / covariance).abs() < 1e-9);
        }
    }

    #[test]
    fn the_settling_time_is_that_of_the_error() {
        // No noise in the state: the gain is 0, an error decays by itself, 0.5^5 < 0.05.
        let model = discrete_model(matrix(1, 1, &[0.5]), matrix(1, 1, &[0.0]), &[0.0], 1.0);
        let filter = KalmanFilter::new(&model).expect("a filter");
        assert_eq!((filter.gain[(0, 0)], filter.settling_samples), (0.0, 5));
    }

    #[test]
    fn what_cannot_be_filtered_is_refused() {
        // A second state that grows and is not seen; a measurement without noise or variance.
        let hidden = matrix(2, 2, &[0.5, 0.0, 0.0, 1.5]);
        let noise = [1.0, 0.0, 0.0, 1.0];
        let hidden = discrete_model(hidden, matrix(2, 1, &[1.0, 1.0]), &noise, 1.0);
        let silent = discrete_model(matrix(1, 1, &[0.5]), matrix(1, 1, &[1.0]), &[0.0], 0.0);
        for model in [hidden, silent] {
            let error = KalmanFilter::new(&model).expect_err("no filter");
            assert_eq!(error, ModelError::NoFilter);
        }
    }
}
