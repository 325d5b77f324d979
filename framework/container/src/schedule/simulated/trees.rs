//! Behaviour trees in simulated time: ticked between the executors' cycles, before those of the same
//! time. A tick takes none.

use std::sync::Arc;

use super::Simulated;
use crate::lane::Lane;
use crate::mission::{Calls, Runner};

impl Simulated {
    /// With these behaviour trees, and what they ask of services.
    #[must_use]
    pub fn with_trees(self, trees: Vec<Runner>, calls: Arc<Calls>) -> Self {
        Self {
            trees,
            calls,
            ..self
        }
    }

    /// Makes the calls that trees have asked for; whether there were any.
    pub(super) fn call_for_trees(&mut self, lane: &Lane) -> bool {
        let now_ns = self.environment.clock.now_ns();
        let any = self.calls.make_all(now_ns, lane);
        self.supervisor.attend();
        any
    }

    /// Lets trees begin, once.
    pub(super) fn begin_trees(&mut self) {
        if !std::mem::replace(&mut self.trees_begun, true) {
            self.trees.iter_mut().for_each(Runner::begin);
        }
    }

    /// When the next tick is due.
    pub(super) fn tree_due_ns(&self) -> Option<u64> {
        let now_ns = self.environment.clock.now_ns();
        let due = self.trees.iter().filter_map(Runner::due_ns).min();
        due.map(|due_ns| due_ns.max(now_ns))
    }

    /// Ticks those that are due.
    pub(super) fn tick_trees(&mut self) {
        self.trees.iter_mut().for_each(Runner::tick);
    }

    /// One tree does what it is asked; whether any was asked.
    pub(super) fn obey_in_trees(&mut self) -> bool {
        let mut trees = self.trees.iter_mut();
        let Some(tree) = trees.find(|tree| tree.has_orders()) else {
            return false;
        };
        tree.obey();
        self.supervisor.attend();
        true
    }
}
