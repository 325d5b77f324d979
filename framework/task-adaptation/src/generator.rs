//! The generator, section 4.2: candidates for doing the task, one of each group.
//!
//! The paper enumerates all combinations, groups them (4.2.2) and picks one of each group (4.2.3).
//! Here combinations are only counted; groups are met in the order of their fewest hops, and of each
//! only the representative is made. So the cost grows with the groups that are asked for.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use system_model::task::{ComponentIndex, Placement, RobotIndex, TaskSpecification};

use crate::hops::{Entangled, FewestHops};
use crate::placing::{Found, placements, representative};
use crate::resources::{Shortage, declared_shortages};
use crate::solution::{Solution, lacking, solutions};

/// Steps of all searches for a placement with room, in one generation: less than a second. Where they
/// do not suffice a candidate says so.
const SEARCH_STEPS: usize = 300_000;

/// A way to do the task: Definition 2's composition of components across robots.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// All components in use, in the order of the task.
    pub placements: Vec<Placement>,
    /// Connections between two robots, counted as the task says.
    pub hops: u32,
    /// Whether the robots have room for it.
    pub room: Room,
}

/// Whether the robots have room for a candidate, by what the task says that components need.
#[derive(Debug, Clone, PartialEq)]
pub enum Room {
    /// They have.
    Enough,
    /// They have, but robots are so full that another placement of the candidate's group may have
    /// fewer hops: that was not found out within bounded time.
    EnoughHere,
    /// They have not, nor for any other placement of the candidate's group.
    Lacking(Vec<Shortage>),
    /// They have not, and whether they have for another placement of its group was not found out
    /// within bounded time.
    Unknown(Vec<Shortage>),
}

/// What came of a generation.
#[derive(Debug, Clone, PartialEq)]
pub struct Generation {
    /// How many combinations there are; the largest number if there are more than that.
    pub combinations: u128,
    /// How many groups of equal components with equal instances of sensors and actuators.
    pub groups: u128,
    /// One for each group, in the paper's order: the essential components alone first, then with
    /// others; the first instances first. They are numbered from 1.
    pub candidates: Vec<Candidate>,
    /// Groups beyond the task's limit, and that of what runs where it is not judged.
    pub left_out: u128,
    /// Essential components that no robot has: the reason if there is no candidate.
    pub lacking: Vec<ComponentIndex>,
}

/// Why there is no generation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GenerationError {
    /// Links between components cross each other so often that hops cannot be counted.
    LinksEntangled,
}

impl std::fmt::Display for GenerationError {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(
            "links between the components cross each other so often that node hops cannot be counted",
        )
    }
}

impl std::error::Error for GenerationError {}

impl From<Entangled> for GenerationError {
    fn from(_: Entangled) -> Self {
        Self::LinksEntangled
    }
}

/// Generates the candidates of a task. `running` is what runs now, whose group is left out where
/// the task says so.
pub fn generate(
    task: &TaskSpecification,
    running: Option<&[Placement]>,
) -> Result<Generation, GenerationError> {
    let solutions = solutions(task, task.generation.hops);
    let sum = |of: fn(&Solution) -> u128| {
        let parts = solutions.iter().map(of);
        parts.fold(0_u128, u128::saturating_add)
    };
    let groups = sum(Solution::groups);
    let left_out = running.filter(|_| !task.generation.judges_running);
    let mut groups_open = Groups::new(&solutions)?;
    let mut found = Vec::new();
    let mut budget = SEARCH_STEPS;
    while found.len() < task.generation.limit {
        let Some(group) = groups_open.next_group()? else {
            break;
        };
        let solution = &solutions[group.solution];
        if left_out.is_some_and(|running| group.holds(task, solution, running)) {
            continue;
        }
        let domains = group.domains(solution);
        let chosen = representative(task, solution, &domains, &mut budget)?;
        let mut placements = placements(solution, &chosen.robots);
        placements.sort_unstable();
        let room = match chosen.found {
            Found::Fits => Room::Enough,
            Found::FitsPerhapsNotFirst => Room::EnoughHere,
            Found::NoneFits => Room::Lacking(declared_shortages(task, &placements)),
            Found::GivenUp => Room::Unknown(declared_shortages(task, &placements)),
        };
        let candidate = Candidate {
            placements,
            hops: chosen.hops,
            room,
        };
        found.push(((group.solution, group.robots), candidate));
    }
    found.sort_by(|(one, _), (other, _)| one.cmp(other));
    Ok(Generation {
        combinations: sum(Solution::combinations),
        groups,
        left_out: groups - found.len() as u128,
        candidates: found.into_iter().map(|(_, candidate)| candidate).collect(),
        lacking: lacking(task),
    })
}

/// Components bound to sensors and actuators, the first of them placed.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Group {
    solution: usize,
    robots: Vec<RobotIndex>,
}

/// The groups that have not been met, those that can come to the fewest hops first, then in the
/// paper's order.
struct Groups<'a> {
    solutions: &'a [Solution],
    open: BinaryHeap<Reverse<(u32, Group)>>,
}

impl<'a> Groups<'a> {
    fn new(solutions: &'a [Solution]) -> Result<Self, Entangled> {
        let mut groups = Self {
            solutions,
            open: BinaryHeap::new(),
        };
        for solution in 0..solutions.len() {
            groups.open(Group {
                solution,
                robots: Vec::new(),
            })?;
        }
        Ok(groups)
    }

    fn open(&mut self, group: Group) -> Result<(), Entangled> {
        let solution = &self.solutions[group.solution];
        let domains = group.domains(solution);
        let fewest = FewestHops::new(&domains, &solution.edges)?.of_all();
        self.open.push(Reverse((fewest, group)));
        Ok(())
    }

    fn next_group(&mut self) -> Result<Option<Group>, Entangled> {
        while let Some(Reverse((_, group))) = self.open.pop() {
            let solution = &self.solutions[group.solution];
            let Some(next) = solution.bound.get(group.robots.len()) else {
                return Ok(Some(group));
            };
            for robot in &solution.robots[*next] {
                let mut group = group.clone();
                group.robots.push(*robot);
                self.open(group)?;
            }
        }
        Ok(None)
    }
}

impl Group {
    /// Robots that each component of the solution may be on.
    fn domains(&self, solution: &Solution) -> Vec<Vec<RobotIndex>> {
        let mut domains = solution.robots.clone();
        for (position, robot) in solution.bound.iter().zip(&self.robots) {
            domains[*position] = vec![*robot];
        }
        domains
    }

    /// Whether what runs is of this group.
    fn holds(&self, task: &TaskSpecification, solution: &Solution, running: &[Placement]) -> bool {
        let used = |component: &ComponentIndex| running.iter().any(|it| it.component == *component);
        let mut bound = running
            .iter()
            .filter(|it| task.components[it.component].class.is_bound());
        let placed = |it: &Placement| {
            let mut places = solution.bound.iter().zip(&self.robots);
            places.any(|(at, robot)| solution.components[*at] == it.component && *robot == it.robot)
        };
        running.len() == solution.components.len()
            && solution.components.iter().all(used)
            && bound.all(placed)
    }
}
