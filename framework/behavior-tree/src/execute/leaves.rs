//! Nodes without children.

use super::{Engine, Ticked};
use crate::plan::{Kind, NodeId, Source};
use crate::script::Environment as _;
use crate::status::Status;
use crate::value::Value;

impl Engine<'_> {
    pub(super) fn leaf(&mut self, id: NodeId) -> Ticked {
        let node = self.node(id);
        match node.kind {
            Kind::Script | Kind::ScriptCondition => {
                let Some(script) = &node.script else {
                    return Err(self.bad_port(id, 0, "a script"));
                };
                if node.kind == Kind::Script {
                    self.run(id, script)?;
                    return Ok(Status::Success);
                }
                Ok(match self.holds(id, script)? {
                    true => Status::Success,
                    false => Status::Failure,
                })
            }
            Kind::SetBlackboard => {
                let value = self.input(id, 0).cloned();
                let value = value.ok_or_else(|| self.bad_port(id, 0, "a value"))?;
                self.output(id, 1, value);
                Ok(Status::Success)
            }
            Kind::UnsetBlackboard => {
                if let Source::Entry(slot) = node.ports[0] {
                    self.board.unset(slot);
                }
                Ok(Status::Success)
            }
            Kind::Sleep => {
                if self.begins(id) {
                    self.state_mut(id).since = self.now;
                }
                Ok(match self.elapsed(id) < self.milliseconds(id, 0)? {
                    true => Status::Running,
                    false => Status::Success,
                })
            }
            _ => self
                .with_leaf(id, |leaf, context| leaf.tick(context))
                .map_err(|message| self.error(id, message)),
        }
    }

    /// Writes to the entry that a port refers to; a port that refers to none takes nothing.
    pub(super) fn output(&mut self, id: NodeId, port: usize, value: Value) {
        if let Source::Entry(slot) = self.node(id).ports[port] {
            self.board.set(slot, value);
        }
    }
}
