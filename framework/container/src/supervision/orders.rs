//! What the fault manager asks of an executor: done between two steps, on the executor's own
//! thread, so that nobody else is ever inside a component.

use std::sync::{Arc, OnceLock};

use crossbeam::queue::ArrayQueue;
use fault_manager::ActionId;

use crate::guard::CallLimit;
use crate::lane::Lane;
use crate::wake::Wake;

/// Orders that may wait for one executor: one for each component that it runs, and the emergency
/// stop. A plan has one action at a time for a component; a shared executor of a hundred members is
/// beyond any profile that we have seen.
const QUEUE: usize = 256;

/// The orders of one executor.
pub struct Orders {
    queue: ArrayQueue<Order>,
    wake: Arc<Wake>,
    /// Who takes the orders, once it runs.
    lane: OnceLock<Arc<Lane>>,
}

/// One order.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// The action that it belongs to, whose end is to be reported.
    pub action: Option<ActionId>,
    /// Number of the component in the application.
    pub component: usize,
    /// What to do.
    pub task: Task,
}

/// What is to be done with a component.
#[derive(Debug, Clone, PartialEq)]
pub enum Task {
    /// Recover it in place, or by a fresh instance of the same library.
    Reset {
        /// Restore the newest checkpoint before this time, in nanoseconds.
        checkpoint_before_ns: Option<u64>,
    },
    /// Put the secondary in its place.
    Replace {
        /// Index in the factory's variants.
        variant: usize,
        /// As for a reset.
        checkpoint_before_ns: Option<u64>,
    },
    /// ACTIVE -> INACTIVE.
    Stop,
    /// -> DESTROYED.
    Destroy,
    /// Tell the actuator, let it work once on its safe command, and stop it if `power_off`.
    EmergencyStop {
        /// Stop category 0.
        power_off: bool,
    },
    /// Start the actuator again that an emergency stop has stopped.
    Resume,
    /// Begin a behaviour tree for a fault.
    Handle {
        /// By then it must have ended, in nanoseconds of the container's clock.
        until_ns: u64,
    },
    /// Put a tap on a data port, for an injected fault.
    Tap {
        /// Index of the port.
        port: usize,
    },
}

impl Orders {
    /// No orders; whoever gives one wakes the executor by `wake`.
    pub fn new(wake: Arc<Wake>) -> Self {
        Self {
            queue: ArrayQueue::new(QUEUE),
            wake,
            lane: OnceLock::new(),
        }
    }

    /// Names the lane that takes the orders; the first one named counts.
    pub fn attach(&self, lane: &Arc<Lane>) {
        let _first_one_counts = self.lane.set(Arc::clone(lane));
    }

    /// Whoever takes the orders is in no callback longer than this until the next order is taken;
    /// [`CallLimit::NONE`] takes that back.
    pub fn hurry(&self, limit: CallLimit) {
        if let Some(lane) = self.lane.get() {
            lane.loss().watch().hurry(limit);
        }
    }

    /// Gives an order; false if too many wait.
    #[must_use]
    pub fn give(&self, order: Order) -> bool {
        let given = self.queue.push(order).is_ok();
        self.wake.wake();
        given
    }

    /// Whether there is an order.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    /// Takes the oldest.
    pub fn take(&self) -> Option<Order> {
        self.queue.pop()
    }
}
