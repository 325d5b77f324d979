//! Components are started, stopped, reset and replaced.

use std::sync::Arc;
use std::time::Duration;

use behavior_tree::{Leaf, LeafContext, Status};
use fault_manager::{Condition, OperatorOrder};
use system_model::life_cycle::LifeCycleState;

use super::milliseconds;
use crate::mission::reach::Reach;

/// What is to be done with a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::mission) enum Wish {
    /// It is to work, whatever it does now.
    Works,
    /// It is to be stopped.
    Stopped,
    /// It is to work as another instance than now.
    Renewed(OperatorOrder),
}

/// An order that is given once and watched.
pub(in crate::mission) struct Ordered {
    reach: Arc<Reach>,
    component: usize,
    wish: Wish,
    /// Not carried out by then: it has failed.
    deadline: Duration,
    /// The incarnation before the order, once it has been given.
    given: Option<u32>,
    /// Why it could not be given so far.
    refusal: Option<String>,
}

impl Ordered {
    pub(in crate::mission) fn new(reach: Arc<Reach>, component: usize, wish: Wish) -> Self {
        Self {
            reach,
            component,
            wish,
            deadline: Duration::ZERO,
            given: None,
            refusal: None,
        }
    }

    /// Begins anew.
    pub(super) fn begin(&mut self, now: Duration, timeout: Duration) {
        self.deadline = now.saturating_add(timeout);
        (self.given, self.refusal) = (None, None);
    }

    /// Gives the order when that makes sense, and looks how far it is.
    pub(super) fn look(&mut self, now: Duration) -> Status {
        if self.is_fulfilled() {
            return Status::Success;
        }
        if self.given.is_none() {
            self.give();
            // Where time is simulated nothing happens before the tick is over.
            if self.is_fulfilled() {
                return Status::Success;
            }
        }
        let is_lost = matches!(
            self.reach.condition(self.component),
            Condition::Lost | Condition::Destroyed
        );
        if now < self.deadline && !(is_lost && self.given.is_some()) {
            return Status::Running;
        }
        if let Some(reason) = self.refusal.take() {
            self.reach.notice(&reason);
        }
        Status::Failure
    }

    fn give(&mut self) {
        let before = self.reach.incarnation(self.component);
        let order = match self.wish {
            Wish::Works => OperatorOrder::Reset,
            Wish::Stopped => OperatorOrder::Stop,
            Wish::Renewed(order) => order,
        };
        match self.reach.order(self.component, order) {
            Ok(()) => self.given = Some(before),
            Err(reason) => self.refusal = Some(reason),
        }
    }

    fn is_fulfilled(&self) -> bool {
        let component = self.component;
        match self.wish {
            Wish::Works => self.reach.works(component),
            Wish::Stopped => {
                let condition = self.reach.condition(component);
                let is_down = matches!(condition, Condition::Stopped | Condition::Destroyed);
                is_down && self.reach.state(component) != Some(LifeCycleState::Active)
            }
            Wish::Renewed(_) => {
                let is_newer = |before| self.reach.incarnation(component) > before;
                self.given.is_some_and(is_newer) && self.reach.works(component)
            }
        }
    }
}

impl Leaf for Ordered {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        if context.begins {
            let timeout = milliseconds(context, "timeout_ms")?;
            self.begin(context.now, timeout);
        }
        Ok(self.look(context.now))
    }

    /// What was ordered is carried out all the same: a recovery is not left half-way.
    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}
