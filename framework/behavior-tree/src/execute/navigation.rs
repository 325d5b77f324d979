//! The control nodes of Nav2.

use super::sequences::unless_skipped;
use super::{Engine, Ticked};
use crate::plan::{NodeId, Source};
use crate::script::Environment as _;
use crate::status::Status;
use crate::value::Value;

/// After so many attempts in one tick others may work; more retries than a person would write.
const MAX_ATTEMPTS_IN_A_TICK: u32 = 100;

impl Engine<'_> {
    /// The second child helps when the first fails, which is then tried again, `number_of_retries`
    /// times.
    pub(super) fn recovery(&mut self, id: NodeId) -> Ticked {
        if self.begins(id) {
            let state = self.state_mut(id);
            (state.index, state.count) = (0, 0);
        }
        let retries = self.number(id, 0)?;
        let (main, help) = (self.child(id, 0), self.child(id, 1));
        for _attempt in 0..MAX_ATTEMPTS_IN_A_TICK {
            if self.state(id).index == 0 {
                match self.tick(main)? {
                    Status::Running => return Ok(Status::Running),
                    Status::Failure if f64::from(self.state(id).count) < retries => {
                        self.halt(main);
                        self.state_mut(id).index = 1;
                    }
                    status => return Ok(self.end_recovery(id, status)),
                }
            }
            match self.tick(help)? {
                Status::Running => return Ok(Status::Running),
                Status::Success => {
                    self.halt(help);
                    let state = self.state_mut(id);
                    (state.index, state.count) = (0, state.count + 1);
                }
                _ => return Ok(self.end_recovery(id, Status::Failure)),
            }
        }
        *self.is_woken = true;
        Ok(Status::Running)
    }

    fn end_recovery(&mut self, id: NodeId, status: Status) -> Status {
        self.halt_children(id);
        let state = self.state_mut(id);
        (state.index, state.count) = (0, 0);
        status
    }

    /// A sequence whose earlier children are ticked again while a later one runs.
    pub(super) fn pipeline(&mut self, id: NodeId) -> Ticked {
        if self.begins(id) {
            self.state_mut(id).index = 0;
        }
        let children = self.plan.children(id);
        let mut skipped = 0;
        for (position, &child) in children.iter().enumerate() {
            match self.tick(child)? {
                Status::Failure => {
                    self.halt_children(id);
                    self.state_mut(id).index = 0;
                    return Ok(Status::Failure);
                }
                Status::Running if position >= self.state(id).index as usize => {
                    // No tree has so many nodes as would not fit.
                    self.state_mut(id).index = position as u32;
                    return Ok(Status::Running);
                }
                Status::Skipped => skipped += 1,
                _ => {}
            }
        }
        self.halt_children(id);
        self.state_mut(id).index = 0;
        Ok(unless_skipped(skipped == children.len(), Status::Success))
    }

    /// Tries one child after another until one succeeds; the next time it begins behind that one.
    pub(super) fn round_robin(&mut self, id: NodeId) -> Ticked {
        let children = self.plan.children(id);
        if self.begins(id) {
            self.state_mut(id).count = 0;
        }
        let mut skipped = 0;
        while self.state(id).count as usize + skipped < children.len() {
            let index = self.state(id).index as usize;
            let status = self.tick(children[index])?;
            if status == Status::Running {
                return Ok(Status::Running);
            }
            self.state_mut(id).index = ((index + 1) % children.len()) as u32;
            match status {
                Status::Success => {
                    self.halt_children(id);
                    self.state_mut(id).count = 0;
                    return Ok(Status::Success);
                }
                Status::Skipped => skipped += 1,
                _ => self.state_mut(id).count += 1,
            }
        }
        self.halt_children(id);
        let state = self.state_mut(id);
        (state.index, state.count) = (0, 0);
        Ok(unless_skipped(skipped == children.len(), Status::Failure))
    }

    /// A sequence that does not wait for a running child; it ends when all succeed in the same tick.
    pub(super) fn nonblocking(&mut self, id: NodeId) -> Ticked {
        let children = self.plan.children(id);
        let (mut skipped, mut is_running) = (0, false);
        for &child in children {
            match self.tick(child)? {
                Status::Failure => {
                    self.halt_children(id);
                    return Ok(Status::Failure);
                }
                Status::Running => is_running = true,
                Status::Skipped => skipped += 1,
                _ => {}
            }
        }
        if is_running {
            return Ok(Status::Running);
        }
        self.halt_children(id);
        Ok(unless_skipped(skipped == children.len(), Status::Success))
    }

    /// A sequence that keeps on the blackboard which child's turn it is.
    pub(super) fn persistent(&mut self, id: NodeId) -> Ticked {
        if let Source::Entry(slot) = self.node(id).ports[0]
            && let Some(value) = self.board.get(slot)
        {
            let children = self.plan.children(id).len() as f64;
            let index = value.as_number().filter(|it| (0.0..children).contains(it));
            let index = index.ok_or_else(|| self.bad_port(id, 0, "the position of a child"))?;
            // Not negative, and less than the number of children.
            self.state_mut(id).index = index as u32;
        }
        let status = self.in_order_with_memory(id)?;
        if let Source::Entry(slot) = self.node(id).ports[0] {
            let index = self.state(id).index;
            self.board.set(slot, Value::Number(f64::from(index)));
        }
        Ok(status)
    }
}
