//! What changes in a tree, for the event log, with a bound.

use std::time::Duration;

use behavior_tree::{NodeId, Plan, Status};

/// Changes of nodes that one tree may put on record within a second: a mission changes a few nodes in
/// a few ticks; a tree that flickers is seen to flicker by as many.
const MOST_CHANGES_PER_SECOND: usize = 200;

const SECOND: Duration = Duration::from_secs(1);

/// The states of nodes as they are on record.
pub(super) struct Record {
    known: Vec<Status>,
    /// Since when, and how many changes there were since then.
    second: Duration,
    changes: usize,
}

/// Changes of one tick.
pub(super) struct Changes {
    /// Path and state.
    pub(super) nodes: Vec<(String, &'static str)>,
    /// How many are left out.
    pub(super) left_out: u64,
}

impl Record {
    pub(super) fn new(plan: &Plan) -> Self {
        Self {
            known: vec![Status::Idle; plan.len()],
            second: Duration::ZERO,
            changes: 0,
        }
    }

    /// What has changed since the last time; none if nothing has.
    pub(super) fn changes(
        &mut self,
        now: Duration,
        plan: &Plan,
        of: impl Fn(NodeId) -> Status,
    ) -> Option<Changes> {
        if now >= self.second + SECOND {
            (self.second, self.changes) = (now, 0);
        }
        let mut changes = Changes {
            nodes: Vec::new(),
            left_out: 0,
        };
        for id in plan.node_ids() {
            let (known, status) = (&mut self.known[id.index()], of(id));
            if std::mem::replace(known, status) == status {
                continue;
            }
            if self.changes < MOST_CHANGES_PER_SECOND {
                self.changes += 1;
                let path = plan.describe(id).path.clone();
                changes.nodes.push((path, status.name()));
            } else {
                changes.left_out += 1;
            }
        }
        (!changes.nodes.is_empty() || changes.left_out > 0).then_some(changes)
    }
}
