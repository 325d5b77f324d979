//! Which components a solution is made of (Definitions 4 and 5), before it is said where they run.

use system_model::task::{ComponentIndex, HopCount, RobotIndex, TaskSpecification};

/// Components that do the task together, and how data go between them.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    /// Essential components in the order of the file, then the others likewise. The first of
    /// two instances is taken first in this order, as in the paper's enumeration.
    pub(crate) components: Vec<ComponentIndex>,
    /// Which robots have each of them, in the order of the file.
    pub(crate) robots: Vec<Vec<RobotIndex>>,
    /// Positions in `components` between which a node hop counts.
    pub(crate) edges: Vec<(usize, usize)>,
    /// Positions in `components` of those that are bound to sensors and actuators; where these run
    /// makes a group.
    pub(crate) bound: Vec<usize>,
}

/// Definition 4, Equation (2), and Definition 5: the essential components alone, then with every
/// set of others that the exclusions allow: smaller sets first, sets of one size in the order of the
/// file. Empty if no robot has one of the essential components.
pub(crate) fn solutions(task: &TaskSpecification, hops: HopCount) -> Vec<Solution> {
    let of_kind = |is_essential: bool| {
        let all = task.components.iter().enumerate();
        let found = all.filter(move |(_, component)| component.is_essential == is_essential);
        found.map(|(index, _)| index)
    };
    if !lacking(task).is_empty() {
        return Vec::new();
    }
    let others = of_kind(false).filter(|index| !task.robots_with(*index).is_empty());
    let others: Vec<ComponentIndex> = others.collect();
    let mut sets = vec![Vec::new()];
    grow(task, &others, &mut Vec::new(), &mut sets);
    sets.sort_by_key(Vec::len);
    let solutions = sets.into_iter().map(|set| {
        let components = of_kind(true).chain(set).collect();
        solution(task, components, hops)
    });
    solutions.collect()
}

/// Essential components that no robot has: without them the task cannot be done.
pub(crate) fn lacking(task: &TaskSpecification) -> Vec<ComponentIndex> {
    let components = task.components.iter().enumerate();
    let lacking = components
        .filter(|(index, component)| component.is_essential && task.robots_with(*index).is_empty());
    lacking.map(|(index, _)| index).collect()
}

/// Adds every allowed set that begins with `set` and goes on with some of `others`.
fn grow(
    task: &TaskSpecification,
    others: &[ComponentIndex],
    set: &mut Vec<ComponentIndex>,
    sets: &mut Vec<Vec<ComponentIndex>>,
) {
    for (position, other) in others.iter().enumerate() {
        let excluded = task.exclusions.iter().any(|exclusion| {
            exclusion.contains(other) && set.iter().any(|used| exclusion.contains(used))
        });
        if excluded {
            continue;
        }
        set.push(*other);
        sets.push(set.clone());
        grow(task, &others[position + 1..], set, sets);
        set.pop();
    }
}

fn solution(task: &TaskSpecification, components: Vec<ComponentIndex>, hops: HopCount) -> Solution {
    let position = |index: &ComponentIndex| components.iter().position(|it| it == index);
    let mut edges = Vec::new();
    for link in &task.links {
        let between = link.through.iter().filter(|_| hops == HopCount::Whole);
        let path = [&link.from].into_iter().chain(between).chain([&link.to]);
        let path: Vec<usize> = path.filter_map(position).collect();
        edges.extend(path.windows(2).map(|ends| (ends[0], ends[1])));
    }
    let is_bound =
        |(_, index): &(usize, &ComponentIndex)| task.components[**index].class.is_bound();
    Solution {
        robots: components.iter().map(|it| task.robots_with(*it)).collect(),
        bound: components
            .iter()
            .enumerate()
            .filter(is_bound)
            .map(|(position, _)| position)
            .collect(),
        components,
        edges,
    }
}

impl Solution {
    /// How many ways there are to place all components.
    pub(crate) fn combinations(&self) -> u128 {
        product(self.robots.iter().map(Vec::len))
    }

    /// How many parts there are that no link connects.
    pub(crate) fn parts(&self) -> usize {
        let mut part: Vec<usize> = (0..self.components.len()).collect();
        for (one, other) in &self.edges {
            let (from, to) = (part[*one], part[*other]);
            part.iter_mut()
                .filter(|it| **it == from)
                .for_each(|it| *it = to);
        }
        part.sort_unstable();
        part.dedup();
        part.len()
    }

    /// How many ways there are to place those that are bound.
    pub(crate) fn groups(&self) -> u128 {
        product(self.bound.iter().map(|it| self.robots[*it].len()))
    }
}

/// A number that does not fit is as good as the largest that does: nobody counts so far.
fn product(factors: impl Iterator<Item = usize>) -> u128 {
    factors.fold(1, |product, factor| product.saturating_mul(factor as u128))
}
