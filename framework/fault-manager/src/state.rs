//! What the fault manager knows of each component at the moment.

use std::collections::VecDeque;
use std::time::Duration;

use crate::graph::Level;
use crate::ladder::Ladder;
use crate::observation::Symptom;
use crate::plan::ActionId;
use crate::verdict::FaultId;

/// Symptoms that wait until a recovery of their component has ended. A recovery takes milliseconds,
/// within which a few checks of a few ports can complain in each of a few cycles.
pub(crate) const QUEUED_SYMPTOMS: usize = 32;

/// How a component is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Condition {
    /// It works, as far as is known.
    Working,
    /// It is being reset or replaced.
    Recovering,
    /// It is in ERROR; its recovery waits for that of what it needs, or until the emergency stop is
    /// cleared.
    Waiting,
    /// It was stopped, or is being stopped.
    Stopped,
    /// It was destroyed, or is being destroyed; or that failed too, and it counts as gone.
    Destroyed,
    /// It is in ERROR and nothing brings it back: its fault is to be ignored.
    Lost,
    /// It is in ERROR, and its task is done without it.
    Unneeded,
}

/// What is known of one component.
#[derive(Debug, Default)]
pub(crate) struct ComponentState {
    /// The action under way.
    pub work: Option<Work>,
    pub down: Option<Down>,
    pub ladder: Ladder,
    /// Symptoms that came during the recovery, oldest first.
    pub queue: VecDeque<Symptom>,
    /// A failure before the application ran.
    pub held: Option<Symptom>,
    /// Newest incarnation that has been heard of.
    pub incarnation: u32,
}

/// A component that is not there any more.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Down {
    pub condition: Condition,
    /// The fault that brought it down.
    pub by: FaultId,
}

impl Down {
    /// How far it is down.
    pub fn level(self) -> Level {
        match self.condition {
            Condition::Destroyed => Level::Destroyed,
            // Who needed it does something else now.
            Condition::Unneeded => Level::Up,
            _ => Level::Stopped,
        }
    }
}

/// An action under way.
#[derive(Debug, Clone)]
pub(crate) struct Work {
    pub id: ActionId,
    pub fault: FaultId,
    pub task: Task,
    pub deadline: Duration,
    /// The incarnation that is to show that it works, once the action itself has ended.
    pub ended: Option<u32>,
    /// The incarnation that has shown so before the end of the action was known.
    pub worked: Option<u32>,
}

/// What an action is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Task {
    Recover,
    Adapt,
    Stop,
    Destroy,
}

impl ComponentState {
    /// The recovery under way, if that is what is under way.
    pub fn recovery(&self) -> Option<&Work> {
        let recovers = |work: &&Work| matches!(work.task, Task::Recover | Task::Adapt);
        self.work.as_ref().filter(recovers)
    }

    /// Keeps a symptom for later; says whether one had to be given up for it. The oldest are kept,
    /// save that a failure, which leaves the component in ERROR, takes the place of the newest.
    pub fn enqueue(&mut self, symptom: Symptom) -> bool {
        let full = self.queue.len() == QUEUED_SYMPTOMS;
        if full && symptom.runs {
            return true;
        }
        if full {
            self.queue.pop_back();
        }
        self.queue.push_back(symptom);
        full
    }
}
