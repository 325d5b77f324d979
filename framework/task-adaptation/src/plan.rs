//! A decision without a robot: by what the task says of its robots and estimates.

use std::collections::HashMap;

use system_model::task::{ComponentIndex, HopCount, RobotIndex, TaskSpecification};

use crate::estimate::{Answer, given};
use crate::generator::{Candidate, Generation, GenerationError, generate};
use crate::judge::{Choice, choose, judge_all, nearest};
use crate::verdict::{Judged, Nearest};

/// What would be decided.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// All candidates, and how many combinations and groups there are.
    pub generation: Generation,
    /// The candidates, judged.
    pub judged: Vec<Judged>,
    /// Which one it would be.
    pub choice: Choice,
    /// What comes nearest, if none is feasible.
    pub nearest: Option<Nearest>,
    /// Groups that would be represented by another candidate if node hops were counted the other way.
    pub differences: Vec<Difference>,
}

/// A group whose representative depends on how node hops are counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Number of the candidate that represents it.
    pub number: usize,
    /// Which one it would be, with its hops counted the other way.
    pub otherwise: Candidate,
    /// Hops of the representative, counted the other way.
    pub hops_otherwise: u32,
}

/// Generates and judges the candidates of a task and chooses one.
pub fn plan(task: &TaskSpecification) -> Result<Plan, GenerationError> {
    let running = task.running.as_deref();
    let generation = generate(task, running)?;
    let answers = generation.candidates.iter();
    let answers = answers.map(|candidate| Answer::Performances(given(task, &candidate.placements)));
    let mut judged = judge_all(task, &generation.candidates, &answers.collect::<Vec<_>>());
    let choice = choose(task, &mut judged, running);
    Ok(Plan {
        nearest: match choice {
            Choice::Nothing => nearest(task, &judged),
            _ => None,
        },
        differences: differences(task, &generation)?,
        generation,
        judged,
        choice,
    })
}

/// Where the other way of counting hops leads to another representative.
fn differences(
    task: &TaskSpecification,
    generation: &Generation,
) -> Result<Vec<Difference>, GenerationError> {
    let mut other_way = task.clone();
    other_way.generation.hops = match task.generation.hops {
        HopCount::Whole => HopCount::Essential,
        HopCount::Essential => HopCount::Whole,
    };
    let others = generate(&other_way, task.running.as_deref())?.candidates;
    let others = others.into_iter().map(|other| (group(task, &other), other));
    let mut others: HashMap<Vec<Role>, Candidate> = others.collect();
    let candidates = generation.candidates.iter().enumerate();
    let differences = candidates.filter_map(|(index, candidate)| {
        let otherwise = others.remove(&group(task, candidate))?;
        (otherwise.placements != candidate.placements).then(|| Difference {
            number: index + 1,
            otherwise,
            hops_otherwise: hops(&other_way, candidate),
        })
    });
    Ok(differences.collect())
}

/// A component in use, and its robot where that matters.
type Role = (ComponentIndex, Option<RobotIndex>);

fn group(task: &TaskSpecification, candidate: &Candidate) -> Vec<Role> {
    let roles = candidate.placements.iter().map(|placement| {
        let class = task.components[placement.component].class;
        (
            placement.component,
            class.is_bound().then_some(placement.robot),
        )
    });
    roles.collect()
}

/// Hops of a candidate as a task counts them.
fn hops(task: &TaskSpecification, candidate: &Candidate) -> u32 {
    let robot = |component: &usize| {
        let mut placements = candidate.placements.iter();
        let found = placements.find(|placement| placement.component == *component);
        found.map(|placement| placement.robot)
    };
    let links = task.links.iter().map(|link| {
        let between = link
            .through
            .iter()
            .filter(|_| task.generation.hops == HopCount::Whole);
        let path = [&link.from].into_iter().chain(between).chain([&link.to]);
        let path: Vec<usize> = path.filter_map(robot).collect();
        path.windows(2).filter(|ends| ends[0] != ends[1]).count() as u32
    });
    links.sum()
}
