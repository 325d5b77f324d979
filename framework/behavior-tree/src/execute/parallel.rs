//! Control nodes all of whose children are ticked in each tick until they complete.

use super::sequences::unless_skipped;
use super::{Engine, Ticked};
use crate::plan::NodeId;
use crate::status::Status;

/// How many children have completed so far.
#[derive(Default)]
struct Tally {
    successes: usize,
    failures: usize,
    skipped: usize,
}

impl Engine<'_> {
    /// Ends as soon as enough children have succeeded, or too many failed.
    pub(super) fn parallel(&mut self, id: NodeId) -> Ticked {
        let needed = self.threshold(id, 0)?;
        let tolerated = self.threshold(id, 1)?;
        let skipped_count_as_successes = self.number(id, 0)? < 0.0;
        self.clear_marks(id);
        let children = self.plan.children(id);
        let mut tally = self.tally(id);
        for &child in children {
            self.tick_unless_completed(child, &mut tally)?;
            let successes = match skipped_count_as_successes && tally.skipped < children.len() {
                true => tally.successes + tally.skipped,
                false => tally.successes,
            };
            let is_lost = children.len() - tally.failures < needed || tally.failures >= tolerated;
            // A parallel with `failure_count="0"` would else fail before anything has happened.
            let is_lost = is_lost && tally.failures > 0;
            if successes >= needed || is_lost {
                self.halt_children(id);
                return Ok(match successes >= needed {
                    true => Status::Success,
                    false => Status::Failure,
                });
            }
        }
        Ok(unless_skipped(
            tally.skipped == children.len(),
            Status::Running,
        ))
    }

    /// Ends when all children have completed.
    pub(super) fn parallel_all(&mut self, id: NodeId) -> Ticked {
        let tolerated = self.threshold(id, 0)?;
        self.clear_marks(id);
        let children = self.plan.children(id);
        let mut tally = self.tally(id);
        for &child in children {
            self.tick_unless_completed(child, &mut tally)?;
        }
        if tally.skipped == children.len() {
            return Ok(Status::Skipped);
        }
        if tally.successes + tally.failures + tally.skipped < children.len() {
            return Ok(Status::Running);
        }
        self.halt_children(id);
        Ok(match tally.failures >= tolerated {
            true => Status::Failure,
            false => Status::Success,
        })
    }

    /// A number of children; a negative one counts from all of them: -1 is all, -2 all but one.
    fn threshold(&self, id: NodeId, port: usize) -> Ticked<usize> {
        let children = self.plan.children(id).len();
        let written = self.number(id, port)?;
        let number = match written < 0.0 {
            true => (children as f64 + written + 1.0).max(0.0),
            false => written,
        };
        match number <= children as f64 {
            // Not negative, and at most the number of children.
            true => Ok(number as usize),
            false => Err(self.bad_port(id, port, &format!("at most {children}, its children,"))),
        }
    }

    fn clear_marks(&mut self, id: NodeId) {
        if self.begins(id) {
            let plan = self.plan;
            for &child in plan.children(id) {
                self.state_mut(child).mark = Status::Idle;
            }
        }
    }

    fn tally(&self, id: NodeId) -> Tally {
        let mut tally = Tally::default();
        for &child in self.plan.children(id) {
            match self.state(child).mark {
                Status::Success => tally.successes += 1,
                Status::Failure => tally.failures += 1,
                _ => {}
            }
        }
        tally
    }

    fn tick_unless_completed(&mut self, child: NodeId, tally: &mut Tally) -> Ticked<()> {
        if self.state(child).mark.is_completed() {
            return Ok(());
        }
        let status = self.tick(child)?;
        match status {
            Status::Success => tally.successes += 1,
            Status::Failure => tally.failures += 1,
            Status::Skipped => tally.skipped += 1,
            _ => return Ok(()),
        }
        if status.is_completed() {
            self.state_mut(child).mark = status;
        }
        Ok(())
    }
}
