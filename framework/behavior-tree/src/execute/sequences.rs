//! Sequences and fallbacks. One is the other with success and failure exchanged: `go_on` is what
//! leads to the next child.

use super::{Engine, Ticked};
use crate::plan::NodeId;
use crate::status::Status;

impl Engine<'_> {
    /// Goes on at the child that was running. One that `yields` lets others work after each child
    /// that completes at once.
    pub(super) fn in_order(&mut self, id: NodeId, go_on: Status, yields: bool) -> Ticked {
        if self.begins(id) {
            let state = self.state_mut(id);
            (state.index, state.skipped) = (0, 0);
        }
        let children = self.plan.children(id);
        while let Some(&child) = children.get(self.state(id).index as usize) {
            let began = self.begins(child);
            match self.tick(child)? {
                Status::Running => return Ok(Status::Running),
                Status::Skipped => self.state_mut(id).skipped += 1,
                status if status != go_on => {
                    self.halt_children(id);
                    self.state_mut(id).index = 0;
                    return Ok(status);
                }
                _ => {
                    let is_last = self.state(id).index as usize + 1 == children.len();
                    if yields && began && !is_last {
                        self.state_mut(id).index += 1;
                        *self.is_woken = true;
                        return Ok(Status::Running);
                    }
                }
            }
            self.state_mut(id).index += 1;
        }
        self.end_in_order(id, go_on)
    }

    /// As a sequence; but after a failure it begins at the child that failed.
    pub(super) fn in_order_with_memory(&mut self, id: NodeId) -> Ticked {
        if self.begins(id) {
            self.state_mut(id).skipped = 0;
        }
        let children = self.plan.children(id);
        while let Some(&child) = children.get(self.state(id).index as usize) {
            match self.tick(child)? {
                Status::Running => return Ok(Status::Running),
                Status::Skipped => self.state_mut(id).skipped += 1,
                Status::Success => {}
                status => {
                    self.halt_children(id);
                    return Ok(status);
                }
            }
            self.state_mut(id).index += 1;
        }
        self.end_in_order(id, Status::Success)
    }

    /// Begins at the first child in every tick; while one child runs all others are halted.
    pub(super) fn anew(&mut self, id: NodeId, go_on: Status) -> Ticked {
        let children = self.plan.children(id);
        let mut all_skipped = true;
        for &child in children {
            match self.tick(child)? {
                Status::Running => {
                    for &other in children.iter().filter(|other| **other != child) {
                        self.halt(other);
                    }
                    return Ok(Status::Running);
                }
                Status::Skipped => {}
                status if status != go_on => {
                    self.halt_children(id);
                    return Ok(status);
                }
                _ => all_skipped = false,
            }
        }
        self.halt_children(id);
        Ok(unless_skipped(all_skipped, go_on))
    }

    fn end_in_order(&mut self, id: NodeId, status: Status) -> Ticked {
        self.halt_children(id);
        let children = self.plan.children(id).len();
        let state = self.state_mut(id);
        let all_skipped = state.skipped as usize == children;
        (state.index, state.skipped) = (0, 0);
        Ok(unless_skipped(all_skipped, status))
    }
}

/// A node all of whose children were skipped is skipped itself.
pub(super) fn unless_skipped(all_skipped: bool, status: Status) -> Status {
    match all_skipped {
        true => Status::Skipped,
        false => status,
    }
}
