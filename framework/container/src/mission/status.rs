//! What is known of a tree, readable from any thread at any time.

use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use behavior_tree::{NodeId, Plan, Status};

/// What a tree does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Phase {
    /// It has not begun: a fault rule has not asked for it yet.
    Waiting,
    /// It is ticked.
    Running,
    /// Its root has answered SUCCESS.
    Success,
    /// Its root has answered FAILURE, or SKIPPED.
    Failure,
    /// It could not do its work: that is a fault.
    Failed,
    /// The fault manager has stopped it.
    Stopped,
}

const PHASES: [Phase; 6] = [
    Phase::Waiting,
    Phase::Running,
    Phase::Success,
    Phase::Failure,
    Phase::Failed,
    Phase::Stopped,
];

impl Phase {
    /// The word in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Running => "running",
            Self::Success => "success",
            Self::Failure => "failure",
            Self::Failed => "failed",
            Self::Stopped => "stopped",
        }
    }
}

/// What is known of a tree.
#[derive(Debug)]
pub struct TreeStatus {
    /// Its name.
    pub name: String,
    /// What is ticked.
    pub plan: Arc<Plan>,
    phase: AtomicU8,
    ticks: AtomicU64,
    longest_ns: AtomicU64,
    /// By node, as of the end of the last tick.
    nodes: Mutex<Vec<Status>>,
}

impl TreeStatus {
    /// A tree that has not begun.
    pub fn new(name: String, plan: Arc<Plan>) -> Self {
        Self {
            name,
            phase: AtomicU8::new(0),
            ticks: AtomicU64::new(0),
            longest_ns: AtomicU64::new(0),
            nodes: Mutex::new(vec![Status::Idle; plan.len()]),
            plan,
        }
    }

    /// What it does.
    pub fn phase(&self) -> Phase {
        PHASES[usize::from(self.phase.load(Ordering::Acquire)) % PHASES.len()]
    }

    /// Ticks so far.
    pub fn ticks(&self) -> u64 {
        self.ticks.load(Ordering::Relaxed)
    }

    /// How long the longest tick took, by the machine's clock; 0 where time is simulated.
    pub fn longest_ns(&self) -> u64 {
        self.longest_ns.load(Ordering::Relaxed)
    }

    /// The nodes that are running, each before its children.
    pub fn running(&self) -> Vec<NodeId> {
        let nodes = self.nodes.lock().unwrap_or_else(PoisonError::into_inner);
        let ids = self.plan.node_ids();
        ids.filter(|id| nodes[id.index()] == Status::Running)
            .collect()
    }

    pub(super) fn set_phase(&self, phase: Phase) {
        let index = PHASES.iter().position(|other| *other == phase);
        let index = index.and_then(|index| u8::try_from(index).ok());
        self.phase.store(index.unwrap_or(0), Ordering::Release);
    }

    pub(super) fn count_tick(&self, took_ns: u64) {
        self.ticks.fetch_add(1, Ordering::Relaxed);
        self.longest_ns.fetch_max(took_ns, Ordering::Relaxed);
    }

    /// Takes the states of nodes after a tick, if nobody looks at them just now.
    pub(super) fn set_nodes(&self, of: impl Fn(NodeId) -> Status) {
        if let Ok(mut nodes) = self.nodes.try_lock() {
            for (id, status) in self.plan.node_ids().zip(nodes.iter_mut()) {
                *status = of(id);
            }
        }
    }
}
