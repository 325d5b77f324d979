//! From state space to samples.

use std::time::Duration;

use nalgebra::{DMatrix, DVector};
use system_model::process_model::{Matrix, ProcessModel, StateSpaceKind};

use super::ModelError;

/// The exponential of a matrix of this norm is still a number (e^700 < 1e308), and takes few steps.
const EXPONENT_MAXIMUM: f64 = 700.0;

/// x(k+1) = A x(k) + B u(k - delay) + w, y(k) = C x(k) + D u(k - delay) + v.
#[derive(Debug, Clone)]
pub struct DiscreteModel {
    /// States x states.
    pub a: DMatrix<f64>,
    /// States x inputs.
    pub b: DMatrix<f64>,
    /// Outputs x states.
    pub c: DMatrix<f64>,
    /// Outputs x inputs.
    pub d: DMatrix<f64>,
    /// Covariance of w.
    pub process_noise: DMatrix<f64>,
    /// Covariance of v.
    pub measurement_noise: DMatrix<f64>,
    /// x(0).
    pub initial: DVector<f64>,
    /// Time between two samples.
    pub period: Duration,
    /// Samples after which an input acts.
    pub delay: usize,
    /// Samples by which an input may act earlier or later.
    pub jitter: f64,
}

impl DiscreteModel {
    /// The model as it is sampled. Of a continuous one, inputs are held between samples (zero-order
    /// hold), and A, B and the noise come from two matrix exponentials (Van Loan, 1978: Computing
    /// integrals involving the matrix exponential, equations 1.2 and 1.4).
    ///
    /// # Errors
    /// When matrices do not fit each other or the result is not finite.
    pub fn new(model: &ProcessModel) -> Result<Self, ModelError> {
        let space = &model.state_space;
        let (states, inputs, outputs) = (space.a.rows, space.b.columns, space.c.rows);
        let shaped = |matrix: &Matrix, rows: usize, columns: usize| {
            let fits = (matrix.rows, matrix.columns) == (rows, columns)
                && Some(matrix.elements.len()) == rows.checked_mul(columns);
            let matrix = || DMatrix::from_row_slice(rows, columns, &matrix.elements);
            fits.then(matrix).ok_or(ModelError::Shape)
        };
        let period_s = space.period.as_secs_f64();
        if states == 0 || outputs == 0 || period_s <= 0.0 || space.initial.len() != states {
            return Err(ModelError::Shape);
        }
        let mut a = shaped(&space.a, states, states)?;
        let mut b = shaped(&space.b, states, inputs)?;
        let mut process_noise = shaped(&model.process_noise, states, states)?;
        if space.kind == StateSpaceKind::Continuous {
            process_noise = sampled_noise(&a, &process_noise, period_s)?;
            (a, b) = sampled(&a, &b, period_s)?;
        }
        let delay = model.input_delay.as_secs_f64() / period_s;
        let model = Self {
            a,
            b,
            c: shaped(&space.c, outputs, states)?,
            d: shaped(&space.d, outputs, inputs)?,
            process_noise,
            measurement_noise: shaped(&model.measurement_noise, outputs, outputs)?,
            initial: DVector::from_column_slice(&space.initial),
            period: space.period,
            delay: delay.round() as usize,
            jitter: model.input_jitter.as_secs_f64() / period_s,
        };
        model.checked()
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.b.ncols()
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.c.nrows()
    }

    /// Variances of the residuals, measured minus simulated, that the noise alone leads to: the
    /// diagonal of C P C' + R with P = sum of A^i Q A'^i over 1024 samples, for ever where the
    /// states decay.
    pub fn residual_variances(&self) -> DVector<f64> {
        let mut power = self.a.clone();
        let mut covariance = self.process_noise.clone();
        for _ in 0..10 {
            covariance += &power * &covariance * power.transpose();
            power = &power * &power;
        }
        (&self.c * covariance * self.c.transpose() + &self.measurement_noise).diagonal()
    }

    fn checked(self) -> Result<Self, ModelError> {
        let matrices = [
            &self.a,
            &self.b,
            &self.c,
            &self.d,
            &self.process_noise,
            &self.measurement_noise,
        ];
        let is_finite = |matrix: &DMatrix<f64>| matrix.iter().all(|element| element.is_finite());
        let all = matrices.into_iter().all(is_finite);
        match all && self.initial.iter().all(|element| element.is_finite()) {
            true => Ok(self),
            false => Err(ModelError::NotFinite),
        }
    }
}

/// exp([A B; 0 0] T) = [A(T) B(T); 0 1].
fn sampled(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    period_s: f64,
) -> Result<(DMatrix<f64>, DMatrix<f64>), ModelError> {
    let (states, inputs) = b.shape();
    let mut block = DMatrix::zeros(states + inputs, states + inputs);
    block.view_mut((0, 0), a.shape()).copy_from(a);
    block.view_mut((0, states), b.shape()).copy_from(b);
    let exponential = exponential(block * period_s)?;
    let sampled_a = exponential.view((0, 0), a.shape()).into_owned();
    let sampled_b = exponential.view((0, states), b.shape()).into_owned();
    Ok((sampled_a, sampled_b))
}

/// exp([-A Q; 0 A'] T) = [.. G; 0 F]: F' G is the covariance that Q leaves after T.
fn sampled_noise(
    a: &DMatrix<f64>,
    density: &DMatrix<f64>,
    period_s: f64,
) -> Result<DMatrix<f64>, ModelError> {
    let states = a.nrows();
    let mut block = DMatrix::zeros(2 * states, 2 * states);
    block.view_mut((0, 0), a.shape()).copy_from(&-a);
    block.view_mut((0, states), a.shape()).copy_from(density);
    block
        .view_mut((states, states), a.shape())
        .copy_from(&a.transpose());
    let exponential = exponential(block * period_s)?;
    let g = exponential.view((0, states), a.shape());
    let f = exponential.view((states, states), a.shape());
    let covariance = f.transpose() * g;
    // Symmetric but for rounding.
    Ok((&covariance + covariance.transpose()) * 0.5)
}

fn exponential(matrix: DMatrix<f64>) -> Result<DMatrix<f64>, ModelError> {
    let column_sums = matrix.column_iter().map(|column| column.abs().sum());
    let norm = column_sums.fold(0.0, f64::max);
    let is_finite = matrix.iter().all(|element| element.is_finite());
    match is_finite && norm <= EXPONENT_MAXIMUM {
        true => Ok(matrix.exp()),
        false => Err(ModelError::NotFinite),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::process_model::tests::{continuous, matrix};

    #[test]
    fn a_first_order_lag_has_its_closed_form() {
        // x' = -2 x + 3 u, noise density 5: e^-2T, 3/2 (1 - e^-2T), 5/4 (1 - e^-4T).
        let model = continuous(matrix(1, 1, &[-2.0]), matrix(1, 1, &[3.0]), &[5.0]);
        let discrete = DiscreteModel::new(&model).expect("a good model");
        let period_s = 0.02_f64;
        let decay = (-2.0 * period_s).exp();
        let close = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        };
        close(discrete.a[(0, 0)], decay);
        close(discrete.b[(0, 0)], 1.5 * (1.0 - decay));
        close(discrete.process_noise[(0, 0)], 1.25 * (1.0 - decay * decay));
    }

    #[test]
    fn a_double_integrator_has_its_closed_form() {
        // x'' = u, white acceleration noise of density 1 (Bar-Shalom et al., 2001, equation 6.2.2-12).
        let a = matrix(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let model = continuous(a, matrix(2, 1, &[0.0, 1.0]), &[0.0, 0.0, 0.0, 1.0]);
        let discrete = DiscreteModel::new(&model).expect("a good model");
        let t = 0.02_f64;
        let expected = [
            (&discrete.a, vec![1.0, t, 0.0, 1.0]),
            (&discrete.b, vec![t * t / 2.0, t]),
            (
                &discrete.process_noise,
                vec![t.powi(3) / 3.0, t * t / 2.0, t * t / 2.0, t],
            ),
        ];
        for (found, expected) in expected {
            let expected = DMatrix::from_row_slice(2, found.ncols(), &expected);
            assert!((found - &expected).norm() < 1e-15, "{found} {expected}");
        }
    }

    #[test]
    fn a_model_without_a_discrete_form_is_refused() {
        let unstable = |pole: f64| continuous(matrix(1, 1, &[pole]), matrix(1, 1, &[1.0]), &[1.0]);
        let cases = [
            (unstable(1e6), ModelError::NotFinite),
            (unstable(-1e6), ModelError::NotFinite),
            (unstable(f64::NAN), ModelError::NotFinite),
            (
                continuous(matrix(1, 1, &[1.0]), matrix(2, 1, &[1.0, 1.0]), &[1.0]),
                ModelError::Shape,
            ),
            (
                continuous(matrix(1, 2, &[1.0, 1.0]), matrix(1, 1, &[1.0]), &[1.0]),
                ModelError::Shape,
            ),
        ];
        for (model, expected) in cases {
            assert_eq!(DiscreteModel::new(&model).expect_err("no form"), expected);
        }
    }

    #[test]
    fn residuals_scatter_as_the_noise_says() {
        // x(k+1) = 0.6 x + w, Q = 0.64: P = 1; C = 1, R = 4.
        let mut model = continuous(matrix(1, 1, &[0.6]), matrix(1, 1, &[1.0]), &[0.64]);
        model.state_space.kind = StateSpaceKind::Discrete;
        model.measurement_noise = matrix(1, 1, &[4.0]);
        let discrete = DiscreteModel::new(&model).expect("a good model");
        assert!((discrete.residual_variances()[0] - 5.0).abs() < 1e-12);
    }
}
