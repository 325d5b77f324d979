//! What of a candidate is run for an estimate, where, and what has to be carried from robot to robot
//! for that. Pure.

use system_model::task::{ComponentClass, Placement, RobotIndex, TaskSpecification};

use super::wiring::{Hop, affected, hops};

/// A part of a rehearsal that is done in one go: consecutive components that one container runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segment {
    /// A robot elsewhere; none for this container.
    pub robot: Option<RobotIndex>,
    /// What is run, in the order in which data flow.
    pub placements: Vec<Placement>,
    /// Data that others need: of which placement by which link.
    pub tell: Vec<(usize, Placement)>,
}

/// How a candidate is estimated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rehearsal {
    /// The candidate's connections.
    pub wanted: Vec<Hop>,
    /// Components that would get other data than now.
    pub affected: Vec<Placement>,
    /// What is to be done, one after the other.
    pub segments: Vec<Segment>,
}

impl Rehearsal {
    /// Plans the estimate of a candidate instead of what runs. `is_here` says which robots this
    /// container runs.
    pub fn new(
        task: &TaskSpecification,
        candidate: &[Placement],
        running: &[Placement],
        is_here: impl Fn(RobotIndex) -> bool,
    ) -> Self {
        let wanted = hops(&task.links, candidate);
        let affected = affected(&wanted, &hops(&task.links, running));
        let rehearsed = rehearsed(task, candidate, running, (&wanted, &affected));
        let holder = |placement: Placement| (!is_here(placement.robot)).then_some(placement.robot);
        let crosses =
            |hop: &&Hop| rehearsed.contains(&hop.to) && holder(hop.from) != holder(hop.to);
        let mut segments: Vec<Segment> = Vec::new();
        for placement in candidate.iter().copied() {
            let told = wanted.iter().filter(crosses);
            let told = told.filter(|hop| hop.from == placement);
            let tell: Vec<_> = told.map(|hop| (hop.link, hop.from)).collect();
            let runs = rehearsed.contains(&placement);
            if !runs && tell.is_empty() {
                continue;
            }
            let robot = holder(placement);
            if segments.last().is_none_or(|last| last.robot != robot) {
                segments.push(Segment {
                    robot,
                    placements: Vec::new(),
                    tell: Vec::new(),
                });
            }
            if let Some(last) = segments.last_mut() {
                last.placements.extend(runs.then_some(placement));
                last.tell.extend(tell);
            }
        }
        Self {
            wanted,
            affected,
            segments,
        }
    }
}

/// What can be run for an estimate: sensors and actuators would reach for their devices, which nobody
/// else may while they run; and where a sensor sleeps there are no data to run on. For those the
/// task's own estimates count.
fn rehearsed(
    task: &TaskSpecification,
    candidate: &[Placement],
    running: &[Placement],
    (wanted, affected): (&[Hop], &[Placement]),
) -> Vec<Placement> {
    let mut rehearsed: Vec<Placement> = Vec::new();
    for placement in candidate {
        let is_data = task.components[placement.component].class == ComponentClass::Computation;
        let sources = wanted.iter().filter(|hop| hop.to == *placement);
        let mut sources = sources.map(|hop| hop.from);
        let is_fed = sources.all(|it| rehearsed.contains(&it) || running.contains(&it));
        if is_data && is_fed && affected.contains(placement) {
            rehearsed.push(*placement);
        }
    }
    rehearsed
}
