//! A tree at work.

use std::sync::Arc;
use std::time::Duration;

use thiserror::Error;

use crate::blackboard::Blackboard;
use crate::execute::{Engine, State};
use crate::leaf::Leaf;
use crate::plan::{NodeId, Plan};
use crate::script::Environment as _;
use crate::status::Status;
use crate::value::Value;

/// A tree at work: a plan, where each node has got to, and the blackboards.
pub struct Tree {
    plan: Arc<Plan>,
    states: Vec<State>,
    board: Blackboard,
    leaves: Vec<Box<dyn Leaf>>,
    is_woken: bool,
}

/// Makes the leaf of a node, or says why it cannot.
pub type MakeLeaf<'a> = dyn FnMut(&Plan, NodeId) -> Result<Box<dyn Leaf>, String> + 'a;

/// Why a tick could not be finished. The tree has been halted then.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{path}: {message}")]
pub struct TickError {
    /// The node, by its path.
    pub path: String,
    /// What went wrong.
    pub message: String,
}

/// Is told of every change of a node's status.
pub trait Observer {
    /// A node's status has changed.
    fn changed(&mut self, node: NodeId, before: Status, now: Status);
}

impl<F: FnMut(NodeId, Status, Status)> Observer for F {
    fn changed(&mut self, node: NodeId, before: Status, now: Status) {
        self(node, before, now);
    }
}

impl Tree {
    /// Makes a tree; `make_leaf` is asked once for each node whose work somebody else does.
    ///
    /// # Errors
    /// What `make_leaf` says of a leaf that it cannot make, with the leaf's path.
    pub fn new(plan: Arc<Plan>, make_leaf: &mut MakeLeaf<'_>) -> Result<Self, TickError> {
        let mut leaves = Vec::with_capacity(plan.leaves.len());
        for &node in &plan.leaves {
            let leaf = make_leaf(&plan, node).map_err(|message| TickError {
                path: plan.describe(node).path.clone(),
                message,
            });
            leaves.push(leaf?);
        }
        Ok(Self {
            states: vec![State::default(); plan.nodes.len()],
            board: Blackboard::new(&plan),
            leaves,
            is_woken: false,
            plan,
        })
    }

    /// The plan.
    pub fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    /// Where a node has got to. A root that has completed keeps its status until the next tick.
    pub fn status(&self, node: NodeId) -> Status {
        self.states[node.index()].status
    }

    /// Ticks the tree once. `now` counts from an origin that is the same for all ticks, and never
    /// goes back. Nothing is allocated, except by leaves, for texts that scripts join, and for an
    /// error.
    ///
    /// # Errors
    /// A script, a port or a leaf that cannot do its work. All that was running has been halted.
    pub fn tick(
        &mut self,
        now: Duration,
        observer: &mut dyn Observer,
    ) -> Result<Status, TickError> {
        self.is_woken = false;
        let root = NodeId::ROOT;
        let mut engine = self.engine(now, observer);
        // A root that has completed begins anew.
        engine.reset(root);
        let ticked = engine.tick(root);
        let trouble = engine.take_trouble();
        let status = match (ticked, trouble) {
            (Ok(status), None) => return Ok(status),
            (Err(error), _) | (Ok(_), Some(error)) => Err(*error),
        };
        engine.halt(root);
        status
    }

    /// Ends all that is running.
    ///
    /// # Errors
    /// The first script `_onHalted` that failed; everything has been halted all the same.
    pub fn halt(&mut self, now: Duration, observer: &mut dyn Observer) -> Result<(), TickError> {
        let mut engine = self.engine(now, observer);
        engine.halt(NodeId::ROOT);
        match engine.take_trouble() {
            Some(error) => Err(*error),
            None => Ok(()),
        }
    }

    /// Forgets all that is running without telling anybody: after a panic in a leaf nobody can say what
    /// that one's state is. The blackboards stay as they are.
    pub fn abandon(&mut self) {
        self.states.fill(State::default());
        self.is_woken = false;
    }

    /// Whether the last tick answered RUNNING only to let others work in between, so that the next
    /// may follow at once: a `Repeat` whose child completes at once does so after each cycle.
    pub fn is_woken(&self) -> bool {
        self.is_woken
    }

    /// The value of a key of the outermost blackboard.
    pub fn entry(&self, key: &str) -> Option<&Value> {
        self.board.get(*self.plan.root_entries.get(key)?)
    }

    /// Gives a key of the outermost blackboard a value; whether the tree uses that key at all.
    pub fn set_entry(&mut self, key: &str, value: Value) -> bool {
        let slot = self.plan.root_entries.get(key);
        if let Some(&slot) = slot {
            self.board.set(slot, value);
        }
        slot.is_some()
    }

    fn engine<'a>(&'a mut self, now: Duration, observer: &'a mut dyn Observer) -> Engine<'a> {
        Engine {
            plan: &self.plan,
            states: &mut self.states,
            board: &mut self.board,
            leaves: &mut self.leaves,
            now,
            observer,
            is_woken: &mut self.is_woken,
            trouble: None,
        }
    }
}
