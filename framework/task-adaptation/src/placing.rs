//! The representative of a group: of all placements of a solution with its sensors and actuators
//! given, the first with the fewest node hops that the robots have room for.

mod search;

use system_model::task::{Placement, RobotIndex, TaskSpecification};

use crate::hops::{Entangled, FewestHops};
use crate::resources::declared_shortages;
use crate::solution::Solution;
use search::Search;

/// What became of the search for a representative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Found {
    /// The robots have room for it.
    Fits,
    /// The robots have room for it; another one with fewer hops, or an earlier one, may fit too.
    FitsPerhapsNotFirst,
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
    let nearest = Representative {
        robots,
        hops: hops.of_all(),
        found: Found::Fits,
    };
    if declared_shortages(task, &placements(solution, &nearest.robots)).is_empty() {
        return Ok(nearest);
    }
    let (found, better) = Search::new(task, solution, domains).run(budget)?;
    let mut chosen = better.unwrap_or(nearest);
    chosen.found = found;
    Ok(chosen)
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
