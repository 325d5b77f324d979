//! Nodes of one child.

use std::time::Duration;

use super::{Engine, Ticked};
use crate::plan::{Kind, NodeId};
use crate::status::Status;
use crate::value::Value;

impl Engine<'_> {
    /// Ticks a decorator. Whenever the child completes it is idle again afterwards.
    pub(super) fn decorator(&mut self, id: NodeId) -> Ticked {
        let child = self.child(id, 0);
        match self.node(id).kind {
            Kind::Inverter => Ok(match self.completed(child)? {
                Status::Success => Status::Failure,
                Status::Failure => Status::Success,
                status => status,
            }),
            Kind::ForceSuccess => self.forced(child, Status::Success),
            Kind::ForceFailure => self.forced(child, Status::Failure),
            Kind::KeepRunningUntilFailure => Ok(match self.completed(child)? {
                Status::Success => Status::Running,
                status => status,
            }),
            Kind::Repeat => self.again(id, child, Status::Success),
            Kind::Retry => self.again(id, child, Status::Failure),
            Kind::Timeout => self.timeout(id, child),
            Kind::Delay => self.delay(id, child),
            Kind::RunOnce => self.run_once(id, child),
            Kind::Precondition => self.precondition(id, child),
            Kind::Loop => self.for_each(id, child),
            Kind::RateController => self.rate(id, child),
            Kind::SingleTrigger => self.single(id, child),
            _ => self.completed(child),
        }
    }

    /// Ticks a child and makes it idle if it has completed.
    pub(super) fn completed(&mut self, child: NodeId) -> Ticked {
        let status = self.tick(child)?;
        self.reset(child);
        Ok(status)
    }

    fn forced(&mut self, child: NodeId, status: Status) -> Ticked {
        let answer = self.completed(child)?;
        Ok(match answer.is_completed() {
            true => status,
            false => answer,
        })
    }

    /// Repeats while the child answers `while_status`; -1 means without end.
    fn again(&mut self, id: NodeId, child: NodeId, while_status: Status) -> Ticked {
        if self.begins(id) {
            self.state_mut(id).count = 0;
        }
        let limit = self.number(id, 0)?;
        let is_left = |count: u32| limit < 0.0 || f64::from(count) < limit;
        while is_left(self.state(id).count) {
            let began = self.begins(child);
            let status = self.completed(child)?;
            if status != while_status {
                return Ok(status);
            }
            let count = self.state(id).count.saturating_add(1);
            self.state_mut(id).count = count;
            if began && is_left(count) {
                *self.is_woken = true;
                return Ok(Status::Running);
            }
        }
        Ok(while_status)
    }

    /// A time of 0 is no limit.
    fn timeout(&mut self, id: NodeId, child: NodeId) -> Ticked {
        let limit = self.milliseconds(id, 0)?;
        if self.begins(id) {
            self.state_mut(id).since = self.now;
        } else if !limit.is_zero() && self.elapsed(id) >= limit {
            self.halt(child);
            return Ok(Status::Failure);
        }
        self.completed(child)
    }

    fn delay(&mut self, id: NodeId, child: NodeId) -> Ticked {
        if self.begins(id) {
            let now = self.now;
            let state = self.state_mut(id);
            (state.since, state.flag) = (now, false);
        }
        if !self.state(id).flag && self.elapsed(id) < self.milliseconds(id, 0)? {
            return Ok(Status::Running);
        }
        self.state_mut(id).flag = true;
        self.completed(child)
    }

    fn run_once(&mut self, id: NodeId, child: NodeId) -> Ticked {
        if self.state(id).flag {
            return match self.boolean(id, 0)? {
                true => Ok(Status::Skipped),
                false => Ok(self.state(id).kept),
            };
        }
        let status = self.completed(child)?;
        if status.is_completed() {
            let state = self.state_mut(id);
            (state.flag, state.kept) = (true, status);
        }
        Ok(status)
    }

    /// Asks only when the child is not running yet.
    fn precondition(&mut self, id: NodeId, child: NodeId) -> Ticked {
        let node = self.node(id);
        let may = match &node.script {
            Some(script) if self.begins(child) => self.holds(id, script)?,
            _ => true,
        };
        match may {
            true => self.completed(child),
            false => self.status_at(id, 1),
        }
    }

    /// One item of a queue after another, one each tick. The queue is a text with `;` between items,
    /// which is read again in each tick and not used up.
    fn for_each(&mut self, id: NodeId, child: NodeId) -> Ticked {
        if self.begins(id) {
            self.state_mut(id).index = 0;
        }
        if self.begins(child) {
            let position = self.state(id).index as usize;
            let item = match self.input(id, 0) {
                Some(Value::Text(text)) => {
                    let mut items = text.split(';').filter(|item| !item.trim().is_empty());
                    items.nth(position).map(Value::of_literal)
                }
                Some(value) => (position == 0).then(|| value.clone()),
                None => None,
            };
            let Some(item) = item else {
                self.state_mut(id).index = 0;
                return self.status_at(id, 1);
            };
            self.output(id, 2, item);
            self.state_mut(id).index += 1;
        }
        match self.completed(child)? {
            Status::Failure => Ok(Status::Failure),
            _ => Ok(Status::Running),
        }
    }

    /// Ticks the child at most so many times a second; a running child is ticked until it completes.
    fn rate(&mut self, id: NodeId, child: NodeId) -> Ticked {
        // Unlike others it goes on counting after it has completed, until its parent makes it idle.
        let begins = self.state(id).status == Status::Idle;
        if begins {
            self.state_mut(id).since = self.now;
        }
        let rate = self.number(id, 0)?;
        let period = Duration::try_from_secs_f64(1.0 / rate.max(0.0));
        // A rate of 0: once and never again.
        let period = period.unwrap_or(Duration::MAX);
        if !(begins || !self.begins(child) || self.elapsed(id) >= period) {
            return Ok(Status::Running);
        }
        let status = self.completed(child)?;
        if status == Status::Success {
            self.state_mut(id).since = self.now;
        }
        Ok(status)
    }

    /// Lets the child complete once, then fails until its parent makes it idle.
    fn single(&mut self, id: NodeId, child: NodeId) -> Ticked {
        if self.state(id).status == Status::Idle {
            self.state_mut(id).flag = false;
        }
        if self.state(id).flag {
            return Ok(Status::Failure);
        }
        let status = self.completed(child)?;
        self.state_mut(id).flag = status.is_completed();
        Ok(status)
    }

    pub(super) fn elapsed(&self, id: NodeId) -> Duration {
        self.now.saturating_sub(self.state(id).since)
    }
}
