//! What an operator asks of the fault manager, from a thread of neither.

use std::time::{Duration, Instant};

use fault_manager::{Condition, FaultId, Observation, OperatorOrder};

use super::{Order, Supervisor, Task};
use crate::event_log::Event;

/// How often it is looked whether another thread has let the fault manager see an observation: that
/// takes it microseconds.
const LOOK_PERIOD: Duration = Duration::from_millis(1);

/// What the fault manager knows at the moment, as far as it takes no time to say.
#[derive(Debug, Clone)]
pub struct Overview {
    /// Whether an emergency stop is latched.
    pub emergency_stop: bool,
    /// By component: how it is doing, and how many of its faults are confirmed and not healed.
    pub components: Vec<(Condition, usize)>,
    /// How many verdicts have been put on record: if it is the same, none has changed.
    pub recorded: u64,
}

impl Supervisor {
    /// What the fault manager knows at the moment.
    pub fn overview(&self) -> Overview {
        let core = self.lock();
        let component = |index| {
            let condition = core.manager.condition(index).unwrap_or(Condition::Working);
            (condition, core.manager.open_faults(index))
        };
        Overview {
            emergency_stop: core.manager.is_emergency(),
            components: (0..self.statuses.len()).map(component).collect(),
            recorded: core.recorded,
        }
    }

    /// Has something done with a component; the number of the verdict that tells what became of it.
    /// Waits at most `limit` until the fault manager has seen it.
    ///
    /// # Errors
    /// Why it makes no sense now, and what to do instead.
    pub fn order(
        &self,
        component: usize,
        order: OperatorOrder,
        limit: Duration,
    ) -> Result<FaultId, String> {
        let before = {
            let core = self.lock();
            if let Some(reason) = core.manager.refusal(component, order) {
                return Err(reason);
            }
            core.manager.newest_order(component)
        };
        if !self.tell(Observation::Ordered { component, order }, limit) {
            return Err("the fault manager is busy; it will be done later".to_owned());
        }
        let newest = self.lock().manager.newest_order(component);
        newest
            .filter(|newest| Some(*newest) != before)
            .ok_or_else(|| "a fault came first; look at 'steadfast fault list'".to_owned())
    }

    /// Leaves an observation and waits until the fault manager has seen it, at most `limit`; whether
    /// it has.
    pub fn tell(&self, observation: Observation, limit: Duration) -> bool {
        let deadline = Instant::now() + limit;
        self.observe(observation);
        // Pending: another thread is at it, and takes this one after others.
        while self.environment().observations.is_pending() {
            if Instant::now() >= deadline {
                return false;
            }
            std::thread::sleep(LOOK_PERIOD);
            self.attend();
        }
        true
    }

    /// Has a tap put on a data port of a component, by the executor that runs it, before the next
    /// cycle.
    pub fn tap(&self, component: usize, port: usize) {
        self.give(Order {
            action: None,
            component,
            task: Task::Tap { port },
        });
    }

    /// Puts something on record that is no fault of a component.
    pub fn notice(&self, message: &str) {
        let event = Event::Notice {
            message: message.to_owned(),
        };
        let environment = self.environment();
        environment.events.record(environment.clock.now_ns(), event);
    }
}
