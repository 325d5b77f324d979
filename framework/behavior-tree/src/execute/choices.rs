//! Control nodes that choose between their children.

use super::sequences::unless_skipped;
use super::{Engine, Ticked};
use crate::plan::NodeId;
use crate::status::Status;

impl Engine<'_> {
    /// The first child decides once which of the others is worked off.
    pub(super) fn if_then_else(&mut self, id: NodeId) -> Ticked {
        if self.begins(id) {
            self.state_mut(id).index = 0;
        }
        let children = self.plan.children(id).len();
        if self.state(id).index == 0 {
            self.state_mut(id).index = match self.tick(self.child(id, 0))? {
                Status::Success => 1,
                Status::Failure if children > 2 => 2,
                Status::Running => return Ok(Status::Running),
                status => return Ok(self.end_choice(id, status)),
            };
        }
        let chosen = self.child(id, self.state(id).index as usize);
        match self.tick(chosen)? {
            Status::Running => Ok(Status::Running),
            status => Ok(self.end_choice(id, status)),
        }
    }

    /// The first child decides in every tick; the one that is not chosen any more is halted.
    pub(super) fn while_do_else(&mut self, id: NodeId) -> Ticked {
        let children = self.plan.children(id);
        let (chosen, other) = match self.tick(children[0])? {
            Status::Success => (Some(&children[1]), children.get(2)),
            Status::Failure => (children.get(2), Some(&children[1])),
            Status::Running => return Ok(Status::Running),
            status => return Ok(self.end_choice(id, status)),
        };
        if let Some(&other) = other {
            self.halt(other);
        }
        let status = match chosen {
            Some(&chosen) => self.tick(chosen)?,
            None => Status::Failure,
        };
        match status {
            Status::Running => Ok(Status::Running),
            status => Ok(self.end_choice(id, status)),
        }
    }

    /// The child whose case equals the variable, else the last one; of several cases that fit the
    /// last counts, as in BehaviorTree.CPP.
    pub(super) fn switch(&mut self, id: NodeId) -> Ticked {
        let children = self.plan.children(id);
        let cases = children.len() - 1;
        let variable = self.input(id, 0);
        let fits = |case: &usize| match (variable, self.input(id, case + 1)) {
            (Some(variable), Some(case)) => variable.equals(case),
            _ => false,
        };
        let chosen = children[(0..cases).rev().find(fits).unwrap_or(cases)];
        for &other in children.iter().filter(|other| **other != chosen) {
            self.halt(other);
        }
        match self.tick(chosen)? {
            Status::Running => Ok(Status::Running),
            status => Ok(self.end_choice(id, status)),
        }
    }

    /// A sequence of all children but the last, which cleans up when one of them fails.
    pub(super) fn try_catch(&mut self, id: NodeId) -> Ticked {
        if self.begins(id) {
            let state = self.state_mut(id);
            (state.index, state.skipped) = (0, 0);
        }
        let children = self.plan.children(id);
        let last = children.len() - 1;
        while (self.state(id).index as usize) < last {
            let index = self.state(id).index as usize;
            match self.tick(children[index])? {
                Status::Running => return Ok(Status::Running),
                Status::Failure => {
                    self.halt_children(id);
                    // No tree has so many nodes as would not fit.
                    self.state_mut(id).index = last as u32;
                    return self.clean_up(id, children[last]);
                }
                Status::Skipped => self.state_mut(id).skipped += 1,
                _ => {}
            }
            self.state_mut(id).index += 1;
            if index + 1 == last {
                let all_skipped = self.state(id).skipped as usize == last;
                return Ok(self.end_choice(id, unless_skipped(all_skipped, Status::Success)));
            }
        }
        self.clean_up(id, children[last])
    }

    fn clean_up(&mut self, id: NodeId, child: NodeId) -> Ticked {
        match self.tick(child)? {
            Status::Running => Ok(Status::Running),
            _ => Ok(self.end_choice(id, Status::Failure)),
        }
    }

    fn end_choice(&mut self, id: NodeId, status: Status) -> Status {
        self.halt_children(id);
        self.state_mut(id).index = 0;
        status
    }
}
