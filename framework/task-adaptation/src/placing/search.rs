//! A placement of a group for which the robots have room.
//!
//! First best first: what hops a beginning comes to at least is known, so placements are met in the
//! order of their hops, and of those with as many the first first. Where robots are nearly full that
//! may take long; then, after a bounded number of steps, straight ahead, the fewest hops first at each
//! component: that finds a placement, but perhaps not the first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use system_model::task::{Placement, RobotIndex, TaskSpecification};

use super::{Found, Representative, robots_of};
use crate::hops::{Entangled, FewestHops};
use crate::resources::suffices;
use crate::solution::Solution;

/// Steps of the best-first search in one group: several for each component of a long chain.
const STEPS_BEST_FIRST: usize = 200;
/// Steps straight ahead: as many as components, and some ways back.
const STEPS_AHEAD: usize = 1000;

/// The first components placed; compared in this order.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Beginning {
    /// Hops of all that begins so, at least.
    at_least: u32,
    /// Positions in the domains.
    choices: Vec<usize>,
    /// Hops of the best that begins so, whether there is room for it or not.
    hops: u32,
}

/// What is to be placed where.
pub(super) struct Search<'a> {
    task: &'a TaskSpecification,
    /// By component: robots that have room for it if nothing else is on them.
    domains: Vec<Vec<RobotIndex>>,
    /// By component and position in its domain: what it needs there.
    needs: Vec<Vec<&'a [f64]>>,
    /// By component: what it and all later ones need of each resource where they need least.
    least: Vec<Vec<f64>>,
    /// What all robots have of each resource.
    all: Vec<f64>,
    edges: &'a [(usize, usize)],
    /// Parts of the solution that no link connects.
    parts: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        task: &'a TaskSpecification,
        solution: &'a Solution,
        domains: &[Vec<RobotIndex>],
    ) -> Self {
        let mut search = Self {
            task,
            domains: vec![Vec::new(); domains.len()],
            needs: vec![Vec::new(); domains.len()],
            least: vec![vec![0.0; task.resources.len()]; domains.len() + 1],
            all: Vec::new(),
            edges: &solution.edges,
            parts: solution.parts(),
        };
        for (position, robots) in domains.iter().enumerate() {
            let component = solution.components[position];
            for robot in robots {
                let robot = *robot;
                let needs = task.instance(Placement { component, robot });
                let needs = needs.map_or(&[][..], |instance| &instance.demand);
                let available = &task.robots[robot].available;
                if available
                    .iter()
                    .zip(needs)
                    .all(|(all, need)| suffices(*all, *need))
                {
                    search.domains[position].push(robot);
                    search.needs[position].push(needs);
                }
            }
        }
        for resource in 0..task.resources.len() {
            let all = task.robots.iter().map(|robot| robot.available[resource]);
            search.all.push(all.sum());
            for position in (0..domains.len()).rev() {
                let needs = search.needs[position].iter().map(|needs| needs[resource]);
                let least = needs.fold(f64::INFINITY, f64::min);
                search.least[position][resource] = search.least[position + 1][resource] + least;
            }
        }
        search
    }

    /// Searches; `budget` is the number of steps that may be taken, and is reduced by those that were.
    pub(super) fn run(
        &self,
        budget: &mut usize,
    ) -> Result<(Found, Option<Representative>), Entangled> {
        if self.domains.iter().any(Vec::is_empty) {
            return Ok((Found::NoneFits, None));
        }
        let hops = FewestHops::new(&self.domains, self.edges)?;
        let (found, best) = self.best_first(&hops, budget);
        if found != Found::GivenUp {
            return Ok((found, best));
        }
        Ok(self.straight_ahead(&hops, budget))
    }

    fn best_first(
        &self,
        hops: &FewestHops<'_>,
        budget: &mut usize,
    ) -> (Found, Option<Representative>) {
        let mut steps = STEPS_BEST_FIRST;
        let mut open = BinaryHeap::from([Reverse(Self::start(hops))]);
        while let Some(Reverse(beginning)) = open.pop() {
            if beginning.choices.len() == self.domains.len() {
                return (Found::Fits, Some(self.found(&beginning)));
            }
            if !step(&mut steps, budget) {
                return (Found::GivenUp, None);
            }
            match self.at_least(&beginning) {
                None => {}
                // Its turn comes when there is nothing with fewer hops.
                Some(at_least) if at_least > beginning.at_least => {
                    open.push(Reverse(Beginning {
                        at_least,
                        ..beginning
                    }));
                }
                Some(_) => open.extend(self.longer(&beginning, hops).into_iter().map(Reverse)),
            }
        }
        (Found::NoneFits, None)
    }

    fn straight_ahead(
        &self,
        hops: &FewestHops<'_>,
        budget: &mut usize,
    ) -> (Found, Option<Representative>) {
        let mut steps = STEPS_AHEAD;
        let mut open = vec![Self::start(hops)];
        while let Some(beginning) = open.pop() {
            if beginning.choices.len() == self.domains.len() {
                return (Found::FitsPerhapsNotFirst, Some(self.found(&beginning)));
            }
            if !step(&mut steps, budget) {
                return (Found::GivenUp, None);
            }
            if self.at_least(&beginning).is_some() {
                let mut longer = self.longer(&beginning, hops);
                longer.sort_unstable_by(|one, other| other.cmp(one));
                open.append(&mut longer);
            }
        }
        (Found::NoneFits, None)
    }

    fn start(hops: &FewestHops<'_>) -> Beginning {
        Beginning {
            at_least: hops.of_all(),
            choices: Vec::new(),
            hops: hops.of_all(),
        }
    }

    fn found(&self, beginning: &Beginning) -> Representative {
        Representative {
            robots: robots_of(&beginning.choices, &self.domains),
            hops: beginning.hops,
            found: Found::Fits,
        }
    }

    /// All beginnings with one component more for which there is room.
    fn longer(&self, beginning: &Beginning, hops: &FewestHops<'_>) -> Vec<Beginning> {
        let left = self.left(&beginning.choices);
        let position = beginning.choices.len();
        let choices = 0..self.domains[position].len();
        let choices = choices.filter(|choice| self.has_room(position, *choice, &left));
        let longer = choices.map(|choice| {
            let mut choices = Vec::with_capacity(self.domains.len());
            choices.extend(&beginning.choices);
            choices.push(choice);
            let sum = hops.after(&choices, beginning.hops);
            Beginning {
                at_least: beginning.at_least.max(sum),
                choices,
                hops: sum,
            }
        });
        longer.collect()
    }

    /// What the chosen components leave of each robot's resources.
    fn left(&self, choices: &[usize]) -> Vec<Vec<f64>> {
        let robots = self.task.robots.iter();
        let mut left: Vec<Vec<f64>> = robots.map(|robot| robot.available.clone()).collect();
        for (position, choice) in choices.iter().enumerate() {
            let left = left[self.domains[position][*choice]].iter_mut();
            let needs = left.zip(self.needs[position][*choice]);
            needs.for_each(|(left, need)| *left -= need);
        }
        left
    }

    fn has_room(&self, position: usize, choice: usize, left: &[Vec<f64>]) -> bool {
        let robot = self.domains[position][choice];
        let needs = left[robot].iter().zip(self.needs[position][choice]);
        let mut needs = needs.zip(&self.task.robots[robot].available);
        // Against the whole, as the sum of all is looked at in the end.
        needs.all(|((left, need), all)| suffices(*all, all - left + need))
    }

    /// The fewest hops that a beginning can come to, as far as that is known; none if there cannot be
    /// room for what is not placed yet: linked components on n robots have n - 1 hops.
    fn at_least(&self, beginning: &Beginning) -> Option<u32> {
        let Beginning {
            at_least, choices, ..
        } = beginning;
        let left = self.left(choices);
        for position in choices.len()..self.domains.len() {
            let mut choices = 0..self.domains[position].len();
            if !choices.any(|choice| self.has_room(position, choice, &left)) {
                return None;
            }
        }
        let mut is_used = vec![false; left.len()];
        for robot in robots_of(choices, &self.domains) {
            is_used[robot] = true;
        }
        let count = is_used.iter().filter(|is_used| **is_used).count();
        let mut robots = count;
        for (resource, all) in self.all.iter().enumerate() {
            let room = |robot: usize| left[robot][resource].max(0.0);
            let (used, others): (Vec<usize>, Vec<usize>) =
                (0..left.len()).partition(|robot| is_used[*robot]);
            let mut lacking = self.least[choices.len()][resource];
            lacking -= used.into_iter().map(room).sum::<f64>();
            let mut others: Vec<f64> = others.into_iter().map(room).collect();
            others.sort_unstable_by(f64::total_cmp);
            let mut needed = count;
            while !suffices(*all, all + lacking) {
                lacking -= others.pop()?;
                needed += 1;
            }
            robots = robots.max(needed);
        }
        let by_room = u32::try_from(robots.saturating_sub(self.parts)).ok()?;
        Some(by_room.max(*at_least))
    }
}

/// Takes a step, if there is one left of both.
fn step(steps: &mut usize, budget: &mut usize) -> bool {
    let is_left = *steps > 0 && *budget > 0;
    if is_left {
        *steps -= 1;
        *budget -= 1;
    }
    is_left
}
