//! Faults are looked for, awaited, reported and cleared.

use std::sync::Arc;
use std::time::Duration;

use behavior_tree::{Leaf, LeafContext, Status};
use fault_manager::Observation;

use super::milliseconds;
use crate::mission::reach::Reach;

/// A fault of a component, of a kind if one is named.
pub(in crate::mission) struct Fault {
    pub(in crate::mission) reach: Arc<Reach>,
    pub(in crate::mission) component: usize,
    pub(in crate::mission) kind: Option<String>,
}

impl Fault {
    fn is_present(&self) -> bool {
        let supervisor = self.reach.supervisor();
        supervisor.has_fault(self.component, self.kind.as_deref())
    }
}

/// Whether a fault is present.
pub(in crate::mission) struct Present(pub(in crate::mission) Fault);

impl Leaf for Present {
    fn tick(&mut self, _context: &mut LeafContext<'_>) -> Result<Status, String> {
        Ok(match self.0.is_present() {
            true => Status::Success,
            false => Status::Failure,
        })
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}

/// Waits for a fault.
pub(in crate::mission) struct Await {
    fault: Fault,
    deadline: Duration,
}

impl Await {
    pub(in crate::mission) fn new(fault: Fault) -> Self {
        Self {
            fault,
            deadline: Duration::ZERO,
        }
    }
}

impl Leaf for Await {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        if context.begins {
            let timeout = milliseconds(context, "timeout_ms")?;
            self.deadline = context.now.saturating_add(timeout);
        }
        Ok(match self.fault.is_present() {
            true => Status::Success,
            false if context.now < self.deadline => Status::Running,
            false => Status::Failure,
        })
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}

/// Clears faults that have healed or are latched, as an operator would.
pub(in crate::mission) struct Clear(pub(in crate::mission) Fault);

impl Leaf for Clear {
    fn tick(&mut self, _context: &mut LeafContext<'_>) -> Result<Status, String> {
        let Fault {
            reach,
            component,
            kind,
        } = &self.0;
        let supervisor = reach.supervisor();
        for id in supervisor.present_faults(*component, kind.as_deref()) {
            supervisor.observe(Observation::Clear(Some(id)));
        }
        Ok(Status::Success)
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}

/// Reports a fault.
pub(in crate::mission) struct Raise {
    pub(in crate::mission) reach: Arc<Reach>,
    /// The component to blame, or the tree.
    pub(in crate::mission) subject: usize,
}

impl Leaf for Raise {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        let message = context.input("message").map(ToString::to_string);
        self.reach.raise(self.subject, message.unwrap_or_default());
        Ok(Status::Success)
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}
