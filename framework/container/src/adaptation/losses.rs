//! What this robot has lost: a component that does not run any more and is not being recovered. The
//! task is then decided upon without it.

use std::time::Duration;

use system_model::life_cycle::LifeCycleState;
use system_model::task::{Placement, TaskSpecification};

use super::local::LocalRobot;
use crate::lane::Lane;

/// A component that has not run for so long is not being recovered: a recovery has a deadline of
/// tens of milliseconds, a reset that waits for its turn one of a second.
const LOST_AFTER: Duration = Duration::from_secs(1);

/// Since when components do not run that should, and which of them count as lost.
#[derive(Debug, Default)]
pub struct Losses {
    down_since: Vec<(usize, Duration)>,
    /// Those that the fault manager has given up, as long as they do not run.
    given_up: Vec<usize>,
    lost: Vec<usize>,
}

impl Losses {
    /// A component cannot be brought back.
    pub(super) fn give_up(&mut self, component: usize) {
        if !self.given_up.contains(&component) {
            self.given_up.push(component);
        }
    }
}

impl LocalRobot {
    /// Looks after what runs: whether what is lost has changed.
    pub(super) fn look_for_losses(&mut self) -> bool {
        let now = self.now();
        let is_down = |component: &usize| {
            let status = &self.statuses[*component];
            let state = status.state();
            !(state == LifeCycleState::Active
                || status.is_dormant() && state != LifeCycleState::Error)
        };
        let parts = self.binding.parts.iter();
        let down: Vec<usize> = parts.map(|it| it.component).filter(is_down).collect();
        let losses = &mut self.losses;
        losses.given_up.retain(|component| down.contains(component));
        losses
            .down_since
            .retain(|(component, _)| down.contains(component));
        for component in down {
            if !losses.down_since.iter().any(|(it, _)| *it == component) {
                losses.down_since.push((component, now));
            }
        }
        let lost = losses.down_since.iter();
        let lost = lost.filter(|(_, since)| *since + LOST_AFTER <= now);
        let mut lost: Vec<usize> = lost.map(|(component, _)| *component).collect();
        lost.extend(&losses.given_up);
        lost.sort_unstable();
        lost.dedup();
        let changed = lost != losses.lost;
        losses.lost = lost;
        changed
    }

    /// The task with what this system's robots have now.
    pub(super) fn task_as_it_is(&self) -> TaskSpecification {
        let mut task = self.binding.task.clone();
        let lost = |placement: Placement| {
            let part = self.binding.part(placement);
            part.is_some_and(|part| self.losses.lost.contains(&part.component))
        };
        for robot in &self.binding.robots {
            let (robot, instances) = (*robot, &mut task.robots[*robot].instances);
            instances.retain(|instance| {
                let component = instance.component;
                !lost(Placement { component, robot })
            });
        }
        task
    }

    /// Stops what does not belong to what runs: a component that failed in a change is recovered by
    /// its rules, and then runs though nobody wants it.
    pub(super) fn keep_asleep(&self, running: &[Placement], lane: &Lane) {
        let wanted = self.members(running);
        for part in &self.binding.parts {
            let is_active = self.statuses[part.component].state() == LifeCycleState::Active;
            if is_active && !wanted.contains(&part.component) && !self.is_started(part.component) {
                self.put_to_sleep(part.component, lane);
            }
        }
    }
}
