//! What a candidate of a Decider or a Reactor costs (ReFRESH; Cui et al., 2015).

use crate::value::Value;

/// From here on a cost is not accepted; what is acceptable lies strictly below.
pub(super) const BOUNDARY: f64 = 1.0;

/// The step in which costs are told apart: they may pass through single precision.
const STEP: f64 = f32::EPSILON as f64;

/// What a Module without an Estimator is expected to cost: acceptable, but behind all that say so.
pub(super) const UNESTIMATED: f64 = BOUNDARY - 2.0 * STEP;

/// What a child that is no Module costs if it can work, so that Modules go first.
pub(super) const PROBED: f64 = BOUNDARY - STEP;

/// What a candidate costs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Cost {
    pub(super) performance: f64,
    pub(super) resource: f64,
}

impl Cost {
    /// The same for both.
    pub(super) fn of_both(cost: f64) -> Self {
        Self {
            performance: cost,
            resource: cost,
        }
    }

    pub(super) fn weighted(self, weights: Self) -> f64 {
        weights.performance * self.performance + weights.resource * self.resource
    }

    pub(super) fn is_feasible(self) -> bool {
        self.performance < BOUNDARY && self.is_resource_feasible()
    }

    pub(super) fn is_resource_feasible(self) -> bool {
        self.resource < BOUNDARY
    }
}

/// A cost as an evaluator writes it: a number, or several with `;` between them, of which the
/// greatest counts. What is no number, or negative, is no cost that could be accepted.
pub(super) fn bottleneck(value: &Value) -> f64 {
    let acceptable = |cost: f64| if cost >= 0.0 { cost } else { f64::MAX };
    match value {
        Value::Text(text) if text.contains(';') => {
            let items = text.split(';').filter(|item| !item.trim().is_empty());
            let costs = items.map(|item| match item.trim().parse::<f64>() {
                Ok(cost) => acceptable(cost),
                Err(_) => f64::MAX,
            });
            costs.fold(0.0, f64::max)
        }
        value => value.as_number().map_or(f64::MAX, acceptable),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_list_the_greatest_counts() {
        for (value, cost) in [
            (Value::Number(0.25), 0.25),
            (Value::Text("0.1;0.9; 0.3".into()), 0.9),
            (Value::Text("0.5".into()), 0.5),
            (Value::Text("0.1;x".into()), f64::MAX),
            (Value::Text("high".into()), f64::MAX),
            (Value::Number(-0.5), f64::MAX),
        ] {
            assert_eq!(bottleneck(&value), cost, "{value}");
        }
    }

    #[test]
    fn what_reaches_the_boundary_is_not_feasible() {
        let cost = |performance, resource| Cost {
            performance,
            resource,
        };
        assert!(cost(0.99, 0.99).is_feasible());
        assert!(!cost(1.0, 0.1).is_feasible());
        assert!(!cost(0.1, 1.0).is_feasible());
        assert!(cost(1.0, 0.1).is_resource_feasible());
        assert!(Cost::of_both(UNESTIMATED).is_feasible());
        assert!(Cost::of_both(PROBED).is_feasible());
        assert!(cost(0.5, 0.5).weighted(cost(0.5, 0.5)) < UNESTIMATED);
        assert!(Cost::of_both(UNESTIMATED).performance < PROBED);
    }
}
