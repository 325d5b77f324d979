//! Nodes that wait for an entry of the blackboard to be written.

use super::{Engine, Ticked};
use crate::plan::{Kind, NodeId, Source};
use crate::status::Status;

impl Engine<'_> {
    pub(super) fn updated(&mut self, id: NodeId) -> Ticked {
        let node = self.node(id);
        let child = self.plan.children(id).first().copied();
        if let Some(child) = child
            && !self.begins(child)
        {
            return self.completed(child);
        }
        let is_new = self.is_new(id);
        match (node.kind, child) {
            (Kind::SkipUnlessUpdated, Some(_)) if !is_new => Ok(Status::Skipped),
            (Kind::WaitValueUpdate, Some(_)) if !is_new => Ok(Status::Running),
            (_, Some(child)) => self.completed(child),
            (_, None) if is_new => Ok(Status::Success),
            (_, None) => Ok(Status::Failure),
        }
    }

    /// Whether the entry was written since this node last asked; a first value counts.
    fn is_new(&mut self, id: NodeId) -> bool {
        let Source::Entry(slot) = self.node(id).ports[0] else {
            return false;
        };
        let writes = self.board.writes(slot);
        let seen = std::mem::replace(&mut self.state_mut(id).writes, writes);
        writes > 0 && writes != seen
    }
}
