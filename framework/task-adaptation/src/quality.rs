//! Definition 6, task solution quality: Equations (3) to (8).
//!
//! The paper leaves open what happens at the edges. Here:
//!
//! * A functional performance P_cf is an error: 0 is perfect, P_th still acceptable, more is not. A
//!   factor of (3) that would be negative is 0, so that two bad components do not make a good one.
//! * A threshold P_th of zero demands perfection: the factor is 1 for no error, else 0.
//! * Sums of (4) are shares of what a robot has for the task, so its summands leave the unit interval
//!   only where more is needed than there is. A summand is then 0, and the solution is infeasible
//!   whatever its other numbers are. The whole is divided by its largest possible value, so that a
//!   threshold means the same for one robot and for ten, and for any scale of the weights β.
//! * A resource that a robot has none of is no summand of that robot: nothing of it is free or used.
//! * N counts all robots of the task, not only those in use: otherwise a solution would gain by
//!   drawing an idle robot in.
//! * α is a factor of all P_F, so by (8) it orders no two solutions otherwise; it says how large a
//!   P_F is compared with its threshold.

/// How well a component does and what it takes, as its evaluator or estimator says.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentPerformance {
    /// P_cf: the functional error in the unit of the component's threshold, 0 is perfect.
    pub functional: f64,
    /// P_cnf before it is divided by what the robot has: use of each resource in its own unit.
    pub use_of_resources: Vec<f64>,
}

/// The numbers of a task solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// P_F of Equation (3), from 0 to α.
    pub functional: f64,
    /// P_NF of Equation (4), from 0 to 1.
    pub non_functional: f64,
    /// P_T of Equation (8).
    pub total: f64,
}

/// One robot's part of Equation (4) for one resource.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResourceUse {
    /// β_j, 0 or more.
    pub weight: f64,
    /// What the robot has for the task, 0 or more, in the resource's unit.
    pub available: f64,
    /// What all components of the solution on this robot use, in the same unit.
    pub used: f64,
}

/// A factor of Equation (3): (P_th - P_cf) / P_th, from 0 to 1.
pub fn component_factor(threshold: f64, error: f64) -> f64 {
    if threshold > 0.0 {
        return ((threshold - error) / threshold).clamp(0.0, 1.0);
    }
    f64::from(u8::from(error <= 0.0))
}

/// Equation (3): P_F = α Π (P_th_i - P_cf_i) / P_th_i over pairs of threshold and error.
pub fn functional_performance(
    weight: f64,
    components: impl IntoIterator<Item = (f64, f64)>,
) -> f64 {
    let factors = components.into_iter();
    let factors = factors.map(|(threshold, error)| component_factor(threshold, error));
    weight * factors.product::<f64>()
}

/// Equation (4): P_NF = Σ_i Σ_j β_j (1 - Σ_k P_cnf_ijk) over robots and resources, divided by its
/// largest possible value; 1 if no resource matters.
pub fn non_functional_performance(robots: &[Vec<ResourceUse>]) -> f64 {
    let (mut free, mut whole) = (0.0, 0.0);
    for resource in robots.iter().flatten() {
        if resource.available > 0.0 {
            let share = resource.used / resource.available;
            free += resource.weight * (1.0 - share).clamp(0.0, 1.0);
            whole += resource.weight;
        }
    }
    if whole > 0.0 { free / whole } else { 1.0 }
}

/// Equations (6) and (7): whether a performance is larger than its threshold.
pub fn exceeds(performance: f64, threshold: f64) -> bool {
    performance > threshold
}

/// Equation (8): P_T = P_F P_NF.
pub fn task_performance(functional: f64, non_functional: f64) -> f64 {
    functional * non_functional
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_stay_in_the_unit_interval() {
        for (threshold, error, factor) in [
            (1.0, 0.0, 1.0),
            (1.0, 0.25, 0.75),
            (4.0, 1.0, 0.75),
            (1.0, 1.0, 0.0),
            (1.0, 3.0, 0.0),
            (0.0, 0.0, 1.0),
            (0.0, 1e-12, 0.0),
        ] {
            assert_eq!(
                component_factor(threshold, error),
                factor,
                "{threshold} {error}"
            );
        }
    }

    #[test]
    fn two_bad_components_are_no_good_one() {
        assert_eq!(functional_performance(1.0, [(1.0, 2.0), (1.0, 2.0)]), 0.0);
        assert_eq!(functional_performance(0.5, [(1.0, 0.5), (2.0, 1.0)]), 0.125);
        assert_eq!(functional_performance(1.0, []), 1.0);
    }

    fn resource(weight: f64, available: f64, used: f64) -> ResourceUse {
        ResourceUse {
            weight,
            available,
            used,
        }
    }

    #[test]
    fn what_is_free_counts_by_its_weight() {
        let table: [(&[ResourceUse], &[ResourceUse], f64); 6] = [
            (&[resource(1.0, 1.0, 0.25)], &[], 0.75),
            (
                &[resource(3.0, 8.0, 8.0), resource(1.0, 2.0, 0.0)],
                &[],
                0.25,
            ),
            (&[resource(1.0, 1.0, 0.5)], &[resource(1.0, 1.0, 0.0)], 0.75),
            // More than there is, and a robot that has nothing of it.
            (&[resource(1.0, 1.0, 5.0)], &[resource(1.0, 1.0, 0.0)], 0.5),
            (&[resource(1.0, 1.0, 0.5)], &[resource(1.0, 0.0, 0.0)], 0.5),
            (&[resource(0.0, 1.0, 0.5)], &[], 1.0),
        ];
        for (first, second, expected) in table {
            let robots = [first.to_vec(), second.to_vec()];
            assert_eq!(non_functional_performance(&robots), expected, "{robots:?}");
        }
    }

    #[test]
    fn a_threshold_must_be_exceeded() {
        assert!(!exceeds(0.5, 0.5) && exceeds(0.51, 0.5) && !exceeds(f64::NAN, 0.5));
        assert_eq!(task_performance(0.5, 0.5), 0.25);
    }
}
