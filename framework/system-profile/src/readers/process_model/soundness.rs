//! Whether a model can be reckoned with: its states stay finite, its noise can be divided by.

use std::time::Duration;

use nalgebra::{Cholesky, DMatrix, Schur};
use system_model::process_model::{Matrix, StateSpaceKind};

use crate::node::Node;

/// Poles nearer to the border of stability than rounding moves them lie on it.
const BORDER: f64 = 1e-9;
/// Eigenvalues of a small matrix take a few iterations each.
const ITERATIONS_MAXIMUM: usize = 10_000;
/// Within one period nothing may grow or decay by more than e^700, the largest number there is.
const EXPONENT_MAXIMUM: f64 = 700.0;
/// A variance so much smaller than another one leaves no digit of it.
const CONDITION_MAXIMUM: f64 = 1e12;

/// Reports states that grow without bound, or for which the period is too long.
pub(super) fn check_stable(node: &Node<'_>, a: &Matrix, kind: StateSpaceKind, period: Duration) {
    let period_s = period.as_secs_f64();
    let matrix = DMatrix::from_row_slice(a.rows, a.columns, &a.elements);
    let column_sums = matrix.column_iter().map(|column| column.abs().sum());
    if kind == StateSpaceKind::Continuous
        && column_sums.fold(0.0, f64::max) * period_s > EXPONENT_MAXIMUM
    {
        node.error(
            "the period is too long for <a>",
            Some("write a shorter period_ms; is <a> per second?".into()),
        );
        return;
    }
    let Some(schur) = Schur::try_new(matrix, f64::EPSILON, ITERATIONS_MAXIMUM) else {
        node.error(
            "the eigenvalues of <a> cannot be found",
            Some("scale the states so that the numbers of <a> are of similar size".into()),
        );
        return;
    };
    // How far the fastest growing pole is beyond the border.
    let poles = schur.complex_eigenvalues();
    let excess = poles.iter().map(|pole| match kind {
        StateSpaceKind::Continuous => pole.re * period_s,
        StateSpaceKind::Discrete => pole.norm() - 1.0,
    });
    let excess = excess.fold(f64::NEG_INFINITY, f64::max);
    if excess > BORDER {
        node.error(
            "the model is not stable: its state grows without bound",
            Some(match kind {
                StateSpaceKind::Continuous => {
                    "the eigenvalues of <a> must not have a positive real part; is a sign wrong?"
                        .into()
                }
                StateSpaceKind::Discrete => {
                    "the eigenvalues of <a> must not be larger than 1; is it kind=\"continuous\"?"
                        .into()
                }
            }),
        );
    } else if excess >= -BORDER {
        node.warning(
            "a state of the model never forgets: its error adds up",
            Some("method=\"chi_square\" corrects the state; the others would drift away".into()),
        );
    }
}

/// Reports measurement noise that cannot be divided by.
pub(super) fn check_definite(node: &Node<'_>, covariance: &Matrix) {
    let size = covariance.rows;
    let matrix = DMatrix::from_row_slice(size, size, &covariance.elements);
    let factor = Cholesky::new(matrix);
    let is_sound = factor.is_some_and(|factor| {
        let deviations = factor.l().diagonal();
        deviations.max() <= deviations.min() * CONDITION_MAXIMUM.sqrt()
    });
    if !is_sound {
        node.error(
            "the measurement noise is singular",
            Some("give each output a variance above 0, that of rounding at least".into()),
        );
    }
}
