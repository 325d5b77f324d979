//! Leaves that only answer, for trees whose leaves are not there.

use std::collections::BTreeMap;
use std::time::Duration;

use crate::leaf::{Leaf, LeafContext};
use crate::plan::{NodeId, Plan};
use crate::status::Status;

/// What stubs answer: SUCCESS, unless said otherwise by name or kind.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct StubAnswers {
    /// By the name of a node, or, where that has none, by its kind.
    pub by_name: BTreeMap<String, StubAnswer>,
}

/// What one stub answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StubAnswer {
    /// The answer.
    pub status: Status,
    /// It answers RUNNING for so long first.
    pub after: Duration,
}

impl StubAnswers {
    /// The leaf for a node, in the form that [`Tree::new`](crate::Tree::new) asks for.
    ///
    /// # Errors
    /// An answer that no node can give: IDLE.
    pub fn make(&self, plan: &Plan, node: NodeId) -> Result<Box<dyn Leaf>, String> {
        let description = plan.describe(node);
        let by = |name: &str| self.by_name.get(name).copied();
        let answer = by(&description.name).or_else(|| by(&description.id));
        let answer = answer.unwrap_or(StubAnswer {
            status: Status::Success,
            after: Duration::ZERO,
        });
        match answer.status {
            Status::Idle => Err("a stub cannot answer IDLE; name another status".into()),
            _ => Ok(Box::new(Stub {
                answer,
                since: Duration::ZERO,
            })),
        }
    }
}

struct Stub {
    answer: StubAnswer,
    since: Duration,
}

impl Leaf for Stub {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        if context.begins {
            self.since = context.now;
        }
        let elapsed = context.now.saturating_sub(self.since);
        Ok(match elapsed < self.answer.after {
            true => Status::Running,
            false => self.answer.status,
        })
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}
