//! Section 4.2 as the paper has it: all combinations, then groups, then one of each. Written without
//! the generator's means, to be compared with it.

use std::collections::BTreeMap;

use system_model::task::{HopCount, Placement, TaskSpecification};

/// A combination: placements in the order of the task, and its hops.
pub type Combination = (Vec<Placement>, u32);

/// Number of the set of components; of those that are bound which is on which robot.
type Group = (usize, Vec<(usize, usize)>);

/// What came of it.
pub struct BruteForce {
    /// How many combinations there are.
    pub combinations: usize,
    /// Of each group, in the paper's order, the first with the fewest hops of those that robots have
    /// room for; of all, if they have room for none. And whether they have.
    pub representatives: Vec<(Combination, bool)>,
}

/// Enumerates everything.
pub fn brute_force(task: &TaskSpecification) -> BruteForce {
    let mut groups: BTreeMap<Group, Vec<Combination>> = BTreeMap::new();
    let mut combinations = 0;
    for (number, set) in sets(task).into_iter().enumerate() {
        let mut all = vec![Vec::new()];
        for component in set {
            let longer = all.iter().flat_map(|placed: &Vec<Placement>| {
                let robots = 0..task.robots.len();
                let mut instances = robots.map(move |robot| Placement { component, robot });
                let mut found = Vec::new();
                for placement in instances.by_ref() {
                    if task.instance(placement).is_some() {
                        found.push([placed.as_slice(), &[placement]].concat());
                    }
                }
                found
            });
            all = longer.collect();
        }
        combinations += all.len();
        for placements in all {
            let bound = placements
                .iter()
                .filter(|it| task.components[it.component].class.is_bound());
            let bound = bound.map(|it| (it.component, it.robot)).collect();
            let hops = hops(task, &placements);
            groups
                .entry((number, bound))
                .or_default()
                .push((placements, hops));
        }
    }
    let representatives = groups.into_values().map(|group| {
        let with_room = group
            .iter()
            .filter(|(placements, _)| has_room(task, placements));
        let (best, fits) = match with_room.min_by_key(|(_, hops)| *hops) {
            Some(best) => (best, true),
            None => (
                group.iter().min_by_key(|(_, hops)| *hops).expect("a group"),
                false,
            ),
        };
        let mut best = best.clone();
        best.0.sort_unstable();
        (best, fits)
    });
    BruteForce {
        combinations,
        representatives: representatives.collect(),
    }
}

/// Components of every solution: essential ones, then every allowed set of others, small sets first.
fn sets(task: &TaskSpecification) -> Vec<Vec<usize>> {
    let all = 0..task.components.len();
    let (essential, others): (Vec<usize>, Vec<usize>) =
        all.partition(|index| task.components[*index].is_essential);
    let mut sets: Vec<Vec<usize>> = (0..1_u32 << others.len())
        .map(|bits| {
            let chosen = others.iter().enumerate();
            let chosen = chosen.filter(|(position, _)| bits & (1 << position) != 0);
            chosen.map(|(_, index)| *index).collect()
        })
        .collect();
    let is_allowed = |set: &Vec<usize>| {
        task.exclusions
            .iter()
            .all(|exclusion| set.iter().filter(|it| exclusion.contains(it)).count() < 2)
    };
    sets.retain(is_allowed);
    sets.sort_by_key(|set| (set.len(), set.clone()));
    sets.iter()
        .map(|set| [essential.as_slice(), set].concat())
        .collect()
}

fn hops(task: &TaskSpecification, placements: &[Placement]) -> u32 {
    let robot = |component: usize| placements.iter().find(|it| it.component == component);
    let mut hops = 0;
    for link in &task.links {
        let mut path = vec![link.from];
        if task.generation.hops == HopCount::Whole {
            path.extend(&link.through);
        }
        path.push(link.to);
        let robots: Vec<usize> = path
            .into_iter()
            .filter_map(robot)
            .map(|it| it.robot)
            .collect();
        hops += robots.windows(2).filter(|pair| pair[0] != pair[1]).count();
    }
    u32::try_from(hops).expect("few links")
}

fn has_room(task: &TaskSpecification, placements: &[Placement]) -> bool {
    (0..task.robots.len()).all(|robot| {
        (0..task.resources.len()).all(|resource| {
            let here = placements.iter().filter(|it| it.robot == robot);
            let needed = here.map(|it| task.instance(*it).expect("there").demand[resource]);
            needed.sum::<f64>() <= task.robots[robot].available[resource] * (1.0 + 1e-9)
        })
    })
}
