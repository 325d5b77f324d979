//! The representative of a group: of all placements of a solution with its sensors and actuators
//! given, the first with the fewest node hops that the robots have room for.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use system_model::task::{Placement, RobotIndex, TaskSpecification};

use crate::hops::{Entangled, FewestHops};
use crate::resources::{declared_shortages, suffices};
use crate::solution::Solution;

/// What became of the search for a representative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Found {
    /// The robots have room for it.
    Fits,
    /// For no placement of the group is there room; this one has the fewest hops.
    NoneFits,
    /// The search was given up; this one has the fewest hops, and there is no room for it.
    GivenUp,
}

/// A placement of all components, in the order of the solution.
pub(crate) struct Representative {
    pub(crate) robots: Vec<RobotIndex>,
    pub(crate) hops: u32,
    pub(crate) found: Found,
}

/// Finds the representative of a group. `domains` has one robot for each bound component. `budget`
/// is the number of steps that may be taken, and is reduced by those that were.
pub(crate) fn representative(
    task: &TaskSpecification,
    solution: &Solution,
    domains: &[Vec<RobotIndex>],
    budget: &mut usize,
) -> Result<Representative, Entangled> {
    let hops = FewestHops::new(domains, &solution.edges)?;
    let robots = robots_of(&hops.first(), domains);
    let mut nearest = Representative {
        robots,
        hops: hops.of_all(),
        found: Found::Fits,
    };
    if declared_shortages(task, &placements(solution, &nearest.robots)).is_empty() {
        return Ok(nearest);
    }
    let search = Search { task, solution };
    let (found, better) = search.run(domains, budget)?;
    nearest.found = found;
    Ok(better.unwrap_or(nearest))
}

/// The placements of a solution, in its order.
pub(crate) fn placements(solution: &Solution, robots: &[RobotIndex]) -> Vec<Placement> {
    let pairs = solution.components.iter().zip(robots);
    let placements = pairs.map(|(component, robot)| Placement {
        component: *component,
        robot: *robot,
    });
    placements.collect()
}

fn robots_of(choices: &[usize], domains: &[Vec<RobotIndex>]) -> Vec<RobotIndex> {
    let pairs = choices.iter().zip(domains);
    pairs.map(|(choice, domain)| domain[*choice]).collect()
}

/// Best first: the fewest hops that a beginning can come to is known exactly, so placements are met
/// in the order of their hops, and of those with as many the first first.
struct Search<'a> {
    task: &'a TaskSpecification,
    solution: &'a Solution,
}

impl Search<'_> {
    fn run(
        &self,
        domains: &[Vec<RobotIndex>],
        budget: &mut usize,
    ) -> Result<(Found, Option<Representative>), Entangled> {
        let nothing = self.left(domains, &[]);
        let domains: Vec<Vec<RobotIndex>> = (0..domains.len())
            .map(|position| self.with_room(position, &domains[position], &nothing))
            .collect();
        if domains.iter().any(Vec::is_empty) {
            return Ok((Found::NoneFits, None));
        }
        let hops = FewestHops::new(&domains, &self.solution.edges)?;
        let mut open = BinaryHeap::from([Reverse((hops.of_all(), Vec::new()))]);
        while let Some(Reverse((sum, choices))) = open.pop() {
            if choices.len() == domains.len() {
                let found = Representative {
                    robots: robots_of(&choices, &domains),
                    hops: sum,
                    found: Found::Fits,
                };
                return Ok((Found::Fits, Some(found)));
            }
            if *budget == 0 {
                return Ok((Found::GivenUp, None));
            }
            *budget -= 1;
            let left = self.left(&domains, &choices);
            let rest = choices.len() + 1..domains.len();
            let mut rest = rest.map(|later| self.with_room(later, &domains[later], &left));
            if rest.any(|robots| robots.is_empty()) {
                continue;
            }
            let position = choices.len();
            for (choice, robot) in domains[position].iter().enumerate() {
                if self.has_room(position, *robot, &left) {
                    let mut choices = choices.clone();
                    choices.push(choice);
                    open.push(Reverse((hops.after(&choices, sum), choices)));
                }
            }
        }
        Ok((Found::NoneFits, None))
    }

    /// What the chosen components leave of each robot's resources.
    fn left(&self, domains: &[Vec<RobotIndex>], choices: &[usize]) -> Vec<Vec<f64>> {
        let robots = self.task.robots.iter();
        let mut left: Vec<Vec<f64>> = robots.map(|robot| robot.available.clone()).collect();
        let robots = robots_of(choices, domains);
        for placement in placements(self.solution, &robots) {
            if let Some(instance) = self.task.instance(placement) {
                let demands = left[placement.robot].iter_mut().zip(&instance.demand);
                demands.for_each(|(left, demand)| *left -= demand);
            }
        }
        left
    }

    fn with_room(
        &self,
        position: usize,
        robots: &[RobotIndex],
        left: &[Vec<f64>],
    ) -> Vec<RobotIndex> {
        let robots = robots.iter().copied();
        robots
            .filter(|robot| self.has_room(position, *robot, left))
            .collect()
    }

    fn has_room(&self, position: usize, robot: RobotIndex, left: &[Vec<f64>]) -> bool {
        let component = self.solution.components[position];
        let instance = self.task.instance(Placement { component, robot });
        instance.is_some_and(|instance| {
            let pairs = left[robot].iter().zip(&instance.demand);
            let available = &self.task.robots[robot].available;
            // Against the whole, as the sum of all is looked at in the end.
            let mut pairs = pairs.zip(available);
            pairs.all(|((left, demand), all)| suffices(*all, all - left + demand))
        })
    }
}
