//! The nodes that adapt: Module, Decider and Reactor of ReFRESH (Cui et al., 2015).
//!
//! A Module is an executor, an evaluator that measures while it runs or when it has ended, and an
//! estimator that says beforehand what it would cost. A Decider does its task by whichever child is
//! best; a Reactor has a nominal task, its last child, and tries the others when that fails.
//!
//! Trying out a child that is no Module means to tick it once, as ReFRESH does; it is halted again.

use super::cost::{BOUNDARY, Cost, PROBED, UNESTIMATED, bottleneck};
use super::{Engine, Ticked};
use crate::definition::NodeClass;
use crate::plan::{Kind, NodeId};
use crate::status::Status;

/// Positions of ports, in the catalogue.
const PERFORMANCE: usize = 0;
const RESOURCE: usize = 1;
const RETRIES: usize = 2;
const FALLBACK_NO_RECONFIG: usize = 3;

/// What a choice came to.
#[derive(Default)]
struct Choice {
    /// The best that is feasible.
    best: Option<usize>,
    /// The best that has at least the resources.
    possible: Option<usize>,
}

impl Engine<'_> {
    pub(super) fn module(&mut self, id: NodeId) -> Ticked {
        let children = self.plan.children(id);
        let (executor, evaluator) = (children[0], children.get(1).copied());
        let begins = self.begins(id);
        if begins {
            let was_estimated = std::mem::take(&mut self.state_mut(id).flag);
            if let Some(&estimator) = children.get(2)
                && !was_estimated
                && self.tick(estimator)? != Status::Success
            {
                return Ok(self.end_module(id, Status::Failure));
            }
            // An evaluator that succeeds now says that there is nothing to do.
            if let Some(evaluator) = evaluator
                && self.tick(evaluator)? == Status::Success
            {
                return Ok(self.end_module(id, Status::Success));
            }
            self.state_mut(id).index = 0;
        }
        if self.state(id).index == 0 {
            match self.tick(executor)? {
                Status::Running => return self.evaluate_running(id, evaluator, begins),
                Status::Success => self.state_mut(id).index = 1,
                _ => return Ok(self.end_module(id, Status::Failure)),
            }
        }
        self.evaluate_ended(id, evaluator)
    }

    /// The executor runs: an evaluator that runs beside it may end it.
    fn evaluate_running(&mut self, id: NodeId, evaluator: Option<NodeId>, begins: bool) -> Ticked {
        let Some(evaluator) = evaluator else {
            return Ok(Status::Running);
        };
        // In its first tick it has been asked already. One that answers at once is asked again only
        // when the executor has ended.
        if begins || self.begins(evaluator) {
            return Ok(Status::Running);
        }
        let status = self.tick(evaluator)?;
        let cost = self.cost(id);
        Ok(match status {
            Status::Running if cost.is_feasible() => Status::Running,
            Status::Success => self.end_module(id, Status::Success),
            _ => self.end_module(id, Status::Failure),
        })
    }

    /// The executor has succeeded: whether the Module has, the evaluator says.
    fn evaluate_ended(&mut self, id: NodeId, evaluator: Option<NodeId>) -> Ticked {
        let Some(evaluator) = evaluator else {
            return Ok(self.end_module(id, Status::Success));
        };
        Ok(match self.tick(evaluator)? {
            Status::Running => Status::Running,
            Status::Success if self.cost(id).performance < BOUNDARY => {
                self.end_module(id, Status::Success)
            }
            _ => self.end_module(id, Status::Failure),
        })
    }

    fn end_module(&mut self, id: NodeId, status: Status) -> Status {
        self.halt_children(id);
        self.state_mut(id).index = 0;
        status
    }

    /// What the blackboard says a Module costs; what it does not say is unknown.
    fn cost(&self, module: NodeId) -> Cost {
        let at = |port| self.input(module, port).map_or(UNESTIMATED, bottleneck);
        Cost {
            performance: at(PERFORMANCE),
            resource: at(RESOURCE),
        }
    }

    pub(super) fn decider(&mut self, id: NodeId) -> Ticked {
        let all = self.plan.children(id).len();
        if self.begins(id) {
            self.clear_choices(id);
            let choice = self.choose(id, all, None)?;
            return Ok(self.go_on_with(id, choice.best));
        }
        let active = self.state(id).index as usize;
        match self.tick_active(id, active)? {
            Status::Failure => self.reconfigure(id, all, active),
            Status::Success => Ok(self.end_adaptive(id, Status::Success)),
            _ => Ok(Status::Running),
        }
    }

    pub(super) fn reactor(&mut self, id: NodeId) -> Ticked {
        let nominal = self.plan.children(id).len() - 1;
        if self.begins(id) {
            self.clear_choices(id);
            return self.enter_nominal(id, nominal, None);
        }
        let active = self.state(id).index as usize;
        match self.tick_active(id, active)? {
            Status::Failure => self.reconfigure(id, nominal, active),
            Status::Success if active == nominal => Ok(self.end_adaptive(id, Status::Success)),
            Status::Success => self.enter_nominal(id, nominal, Some(active)),
            _ => Ok(Status::Running),
        }
    }

    /// The nominal task if it can be entered, else what may make that possible. `mitigated` has just
    /// succeeded.
    fn enter_nominal(&mut self, id: NodeId, nominal: usize, mitigated: Option<usize>) -> Ticked {
        let cost = self.estimate(self.child(id, nominal))?;
        if cost.is_some_and(Cost::is_feasible) {
            return Ok(self.go_on_with(id, Some(nominal)));
        }
        if let Some(active) = mitigated {
            return self.reconfigure(id, nominal, active);
        }
        let choice = self.choose(id, nominal, None)?;
        let possible = match self.boolean(id, FALLBACK_NO_RECONFIG)? {
            true => None,
            false => choice.possible,
        };
        Ok(self.go_on_with(id, choice.best.or(possible)))
    }

    /// Ticks the active child; what it did not do it has failed to do.
    fn tick_active(&mut self, id: NodeId, active: usize) -> Ticked {
        let child = self.child(id, active);
        Ok(match self.tick(child)? {
            Status::Skipped => Status::Failure,
            status => status,
        })
    }

    /// The active child has failed, or has done what it can: another one of the first `candidates`
    /// takes over.
    fn reconfigure(&mut self, id: NodeId, candidates: usize, active: usize) -> Ticked {
        self.halt(self.child(id, active));
        let choice = self.choose(id, candidates, Some(active))?;
        let fallback = match self.boolean(id, FALLBACK_NO_RECONFIG)? {
            true => Some(active),
            false => choice.possible,
        };
        let Some(next) = choice.best.or(fallback) else {
            return Ok(self.end_adaptive(id, Status::Failure));
        };
        let retries = self.number(id, RETRIES)?;
        let chosen = self.child(id, next);
        let times = self.state(chosen).chosen.saturating_add(1);
        self.state_mut(chosen).chosen = times;
        if f64::from(times) > retries {
            return Ok(self.end_adaptive(id, Status::Failure));
        }
        Ok(self.go_on_with(id, Some(next)))
    }

    /// Makes a child the active one; it is ticked in the next tick.
    fn go_on_with(&mut self, id: NodeId, next: Option<usize>) -> Status {
        let Some(next) = next else {
            return self.end_adaptive(id, Status::Failure);
        };
        for (position, &child) in self.plan.children(id).iter().enumerate() {
            if position != next {
                self.halt(child);
                self.forget_estimate(child);
            }
        }
        // No tree has so many nodes as would not fit.
        self.state_mut(id).index = next as u32;
        *self.is_woken = true;
        Status::Running
    }

    fn end_adaptive(&mut self, id: NodeId, status: Status) -> Status {
        self.halt_children(id);
        self.clear_choices(id);
        status
    }

    fn clear_choices(&mut self, id: NodeId) {
        for &child in self.plan.children(id) {
            self.state_mut(child).chosen = 0;
            self.forget_estimate(child);
        }
        self.state_mut(id).index = 0;
    }

    /// The best of the first `candidates` children but the active one: by weighted cost, then by
    /// connection order.
    fn choose(&mut self, id: NodeId, candidates: usize, active: Option<usize>) -> Ticked<Choice> {
        let weights = Cost {
            performance: self.number(id, PERFORMANCE)?,
            resource: self.number(id, RESOURCE)?,
        };
        let retries = self.number(id, RETRIES)?;
        let mut choice = Choice::default();
        let (mut least, mut least_possible) = (f64::INFINITY, f64::INFINITY);
        for position in 0..candidates {
            let child = self.child(id, position);
            if Some(position) == active || f64::from(self.state(child).chosen) > retries {
                continue;
            }
            let Some(cost) = self.estimate(child)? else {
                continue;
            };
            let weighted = cost.weighted(weights);
            if cost.is_feasible() && weighted < least {
                (choice.best, least) = (Some(position), weighted);
            }
            if cost.is_resource_feasible() && weighted < least_possible {
                (choice.possible, least_possible) = (Some(position), weighted);
            }
        }
        Ok(choice)
    }

    /// What a child would cost; none if it says that it cannot work.
    fn estimate(&mut self, child: NodeId) -> Ticked<Option<Cost>> {
        self.halt(child);
        let Some(module) = self.module_of(child) else {
            let status = self.tick(child)?;
            self.halt(child);
            let can_work = matches!(status, Status::Success | Status::Running);
            return Ok(can_work.then(|| Cost::of_both(PROBED)));
        };
        let estimator = self.plan.children(module).get(2).copied();
        let status = match estimator {
            Some(estimator) => {
                let status = self.tick(estimator)?;
                self.halt(estimator);
                status
            }
            None => Status::Success,
        };
        let can_work = status == Status::Success;
        self.state_mut(module).flag = can_work;
        let cost = match estimator {
            Some(_) => self.cost(module),
            None => Cost::of_both(UNESTIMATED),
        };
        Ok(can_work.then_some(cost))
    }

    /// The Module that a child is, in a sub-tree's place as well.
    fn module_of(&self, child: NodeId) -> Option<NodeId> {
        let mut node = child;
        while self.plan.describe(node).class == NodeClass::SubTree {
            node = *self.plan.children(node).first()?;
        }
        (self.node(node).kind == Kind::Module).then_some(node)
    }

    fn forget_estimate(&mut self, child: NodeId) {
        if let Some(module) = self.module_of(child) {
            self.state_mut(module).flag = false;
        }
    }
}
