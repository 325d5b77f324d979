//! What somebody who does the work of leaves must implement.

use std::time::Duration;

use crate::blackboard::Blackboard;
use crate::plan::{NodeId, Plan, Source};
use crate::script::Environment as _;
use crate::status::Status;
use crate::value::Value;

/// An action or a condition. A tick must return at once: what takes time is begun, answered with
/// [`Status::Running`] and looked at again in the next tick.
pub trait Leaf: Send {
    /// Begins or goes on. `context.begins` says which of the two.
    ///
    /// # Errors
    /// What a person should know if it can do neither; the tick of the whole tree fails with it.
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String>;

    /// Ends what is running. Called only after a tick that answered [`Status::Running`].
    fn halt(&mut self, context: &mut LeafContext<'_>);
}

/// What a leaf may know and do in a tick.
#[derive(Debug)]
pub struct LeafContext<'a> {
    /// The time, from an origin that is the same for all ticks of a tree.
    pub now: Duration,
    /// Whether the leaf was not running before.
    pub begins: bool,
    pub(crate) node: NodeId,
    pub(crate) plan: &'a Plan,
    pub(crate) board: &'a mut Blackboard,
}

impl LeafContext<'_> {
    /// The node that is ticked.
    pub fn node(&self) -> NodeId {
        self.node
    }

    /// The value at a port; none if the tree says nothing there, or the blackboard's entry is empty.
    pub fn input(&self, port: &str) -> Option<&Value> {
        match self.source(port)? {
            Source::Nothing => None,
            Source::Literal(value) => Some(value),
            Source::Entry(slot) => self.board.get(*slot),
        }
    }

    /// Whether a port refers to an entry that can be written.
    pub fn has_output(&self, port: &str) -> bool {
        matches!(self.source(port), Some(Source::Entry(_)))
    }

    /// Writes to the entry that a port refers to.
    ///
    /// # Errors
    /// The port refers to none.
    pub fn output(&mut self, port: &str, value: Value) -> Result<(), String> {
        match self.source(port) {
            Some(&Source::Entry(slot)) => {
                self.board.set(slot, value);
                Ok(())
            }
            _ => Err(format!(
                "port {port} refers to no entry of the blackboard; write {port}=\"{{key}}\""
            )),
        }
    }

    fn source(&self, port: &str) -> Option<&Source> {
        let ports = &self.plan.describe(self.node).ports;
        let position = ports.iter().position(|(name, _)| name == port)?;
        self.plan.nodes[self.node.index()].ports.get(position)
    }
}
