//! What a solution needs of each robot, and whether that is there.

use system_model::task::{Placement, ResourceIndex, RobotIndex, TaskSpecification};

use crate::quality::ResourceUse;

/// Sums of decimal fractions miss their goal by rounding: so much, relative to what is there, is no
/// shortage.
const ROUNDING: f64 = 1e-9;

/// More is needed than there is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shortage {
    /// Where.
    pub robot: RobotIndex,
    /// Of what.
    pub resource: ResourceIndex,
    /// How much is needed, in the resource's unit.
    pub needed: f64,
    /// How much there is, in the same unit.
    pub available: f64,
}

/// Whether an amount is there.
pub(crate) fn suffices(available: f64, needed: f64) -> bool {
    needed <= available + ROUNDING * available.abs()
}

/// What placed components use of each robot's resources: one row for each robot, in it one entry for
/// each resource. `uses` has the use of each placement in the order of the placements.
pub fn sums<'a>(
    task: &TaskSpecification,
    placements: &[Placement],
    uses: impl IntoIterator<Item = &'a [f64]>,
) -> Vec<Vec<ResourceUse>> {
    let rows = task.robots.iter().map(|robot| {
        let resources = task.resources.iter().zip(&robot.available);
        resources
            .map(|(resource, available)| ResourceUse {
                weight: resource.weight,
                available: *available,
                used: 0.0,
            })
            .collect()
    });
    let mut rows: Vec<Vec<ResourceUse>> = rows.collect();
    for (placement, uses) in placements.iter().zip(uses) {
        for (sum, used) in rows[placement.robot].iter_mut().zip(uses) {
            sum.used += used;
        }
    }
    rows
}

/// Where more is needed than there is, by robot and resource.
pub fn shortages(sums: &[Vec<ResourceUse>]) -> Vec<Shortage> {
    let mut found = Vec::new();
    for (robot, resources) in sums.iter().enumerate() {
        for (resource, sum) in resources.iter().enumerate() {
            if !suffices(sum.available, sum.used) {
                found.push(Shortage {
                    robot,
                    resource,
                    needed: sum.used,
                    available: sum.available,
                });
            }
        }
    }
    found
}

/// Shortages by what the task says that each instance needs.
pub fn declared_shortages(task: &TaskSpecification, placements: &[Placement]) -> Vec<Shortage> {
    let demands = placements.iter().map(|placement| {
        let instance = task.instance(*placement);
        instance.map_or(&[][..], |instance| &instance.demand)
    });
    shortages(&sums(task, placements, demands))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_no_shortage() {
        assert!(suffices(0.3, 0.1 + 0.1 + 0.1));
        assert!(!suffices(0.3, 0.300_001));
        assert!(suffices(0.0, 0.0) && !suffices(0.0, 0.1));
    }
}
