//! What an operator asks of the fault manager, from a thread of neither.

use std::time::{Duration, Instant};

use fault_manager::Observation;

use super::{Order, Supervisor, Task};
use crate::event_log::Event;

/// How often it is looked whether another thread has let the fault manager see an observation: that
/// takes it microseconds.
const LOOK_PERIOD: Duration = Duration::from_millis(1);

impl Supervisor {
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
