//! The executor of a Module: a component that runs for as long as the node does.

use std::sync::Arc;
use std::time::Duration;

use behavior_tree::{Leaf, LeafContext, Status};
use fault_manager::{Condition, OperatorOrder};

use super::control::{Ordered, Wish};
use super::milliseconds;
use crate::mission::reach::Reach;

/// Runs a component.
pub(in crate::mission) struct Running {
    reach: Arc<Reach>,
    component: usize,
    start: Ordered,
    has_started: bool,
    /// How long the component goes on after the node was halted, unless another one has taken over.
    overlap: Duration,
}

impl Running {
    pub(in crate::mission) fn new(reach: Arc<Reach>, component: usize) -> Self {
        Self {
            start: Ordered::new(Arc::clone(&reach), component, Wish::Works),
            reach,
            component,
            has_started: false,
            overlap: Duration::ZERO,
        }
    }
}

impl Leaf for Running {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        if context.begins {
            self.overlap = milliseconds(context, "overlap_ms")?;
            let timeout = milliseconds(context, "timeout_ms")?;
            self.start.begin(context.now, timeout);
            self.has_started = false;
            self.reach.stay(self.component);
        }
        if !self.has_started {
            match self.start.look(context.now) {
                Status::Success => {
                    self.has_started = true;
                    self.reach.taken_over();
                }
                other => return Ok(other),
            }
        }
        // What the fault manager recovers is not lost.
        Ok(match self.reach.condition(self.component) {
            Condition::Working | Condition::Recovering | Condition::Waiting => Status::Running,
            Condition::Stopped | Condition::Destroyed | Condition::Lost | Condition::Unneeded => {
                Status::Failure
            }
        })
    }

    fn halt(&mut self, context: &mut LeafContext<'_>) {
        let is_now = self.overlap.is_zero();
        if is_now
            && self
                .reach
                .order(self.component, OperatorOrder::Stop)
                .is_ok()
        {
            return;
        }
        let until = context.now.saturating_add(self.overlap);
        self.reach.leave(self.component, until);
    }
}
