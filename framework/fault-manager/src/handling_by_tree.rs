//! The rung of the ladder on which a behaviour tree handles a fault: begun, ended, or too late.

use std::time::Duration;

use crate::manager::FaultManager;
use crate::observation::ActionOutcome;
use crate::plan::{Action, ActionId, Effect};
use crate::verdict::{FaultId, FaultState};
use crate::wording;

/// A tree that is handling a fault.
#[derive(Debug, Clone)]
pub(crate) struct HandledByTree {
    id: ActionId,
    fault: FaultId,
    component: usize,
    deadline: Duration,
    /// The tree has succeeded; its component is still in ERROR.
    has_succeeded: bool,
}

impl FaultManager {
    /// A tree is begun for a fault.
    pub(crate) fn handle_by_tree(&mut self, id: FaultId, component: usize) {
        let own = &self.system.components[component];
        let Some(rule) = own.rules.handle.as_ref().map(|rule| rule.value.clone()) else {
            return;
        };
        let Some(tree) = self.system.tree(own.application, &rule.tree) else {
            // There is none of that name, which a check would have told: the next rung.
            return self.climb(id);
        };
        let action = Action::Handle {
            component,
            tree,
            within: rule.deadline,
        };
        self.plan(id, wording::action(&self.system, &action));
        let deadline = self.now.saturating_add(rule.deadline);
        let number = self.act(id, action, self.now, deadline);
        self.handled.push(HandledByTree {
            id: number,
            fault: id,
            component,
            deadline,
            has_succeeded: false,
        });
    }

    /// The fault of a component that a tree is handling, if one is.
    pub(crate) fn handled_by_tree(&self, component: usize) -> Option<FaultId> {
        let mut handled = self.handled.iter();
        let of_it = handled.find(|handled| handled.component == component);
        of_it.map(|handled| handled.fault)
    }

    /// When the first of them must have ended.
    pub(crate) fn tree_due(&self) -> Option<Duration> {
        self.handled.iter().map(|handled| handled.deadline).min()
    }

    /// If the action is a tree's, notes how it ended.
    pub(crate) fn tree_ended(&mut self, action: ActionId, outcome: &ActionOutcome) -> bool {
        let position = self.handled.iter().position(|it| it.id == action);
        let Some(position) = position else {
            return false;
        };
        match outcome {
            ActionOutcome::Done { note, .. } => {
                let handled = &mut self.handled[position];
                handled.has_succeeded = true;
                let (fault, component) = (handled.fault, handled.component);
                self.note_outcome(fault, action, "done", note.clone());
                if self.is_over_or_runs(fault) {
                    self.handled.remove(position);
                    self.action_over(fault);
                    self.come_back(component, vec![fault]);
                }
            }
            ActionOutcome::Failed { reason } => {
                let handled = self.handled.remove(position);
                self.tree_failed(&handled, "failed", reason.clone());
            }
        }
        true
    }

    /// What time and others change about them: a component that works again, a deadline that is over.
    pub(crate) fn look_at_trees(&mut self, reached: impl Fn(Duration) -> bool) {
        let handled = std::mem::take(&mut self.handled);
        for handled in handled {
            let is_healed = handled.has_succeeded && self.is_over_or_runs(handled.fault);
            if is_healed {
                self.action_over(handled.fault);
            } else if reached(handled.deadline) {
                self.effects.push(Effect::Abandon(handled.id));
                let (outcome, reason) = match handled.has_succeeded {
                    true => (
                        "failed",
                        "the tree succeeded, and the component does not work",
                    ),
                    false => ("overdue", "not ended before the deadline"),
                };
                self.tree_failed(&handled, outcome, reason.to_owned());
            } else {
                self.handled.push(handled);
            }
        }
    }

    /// A component is stopped for another fault: no tree need handle it any more.
    pub(crate) fn overtake_tree(&mut self, component: usize, by: FaultId) {
        let of_it = |handled: &HandledByTree| handled.component == component;
        let Some(position) = self.handled.iter().position(of_it) else {
            return;
        };
        let handled = self.handled.remove(position);
        self.effects.push(Effect::Abandon(handled.id));
        let note = wording::overtaken(by);
        self.note_outcome(handled.fault, handled.id, "abandoned", note);
        self.action_over(handled.fault);
    }

    fn tree_failed(&mut self, handled: &HandledByTree, outcome: &'static str, reason: String) {
        self.note_outcome(handled.fault, handled.id, outcome, reason);
        let is_over = self.is_over(handled.fault);
        if let Some(fault) = self.history.get_mut(handled.fault) {
            fault.pending = fault.pending.saturating_sub(1);
        }
        match is_over {
            // The tree, or something else, has done what was to be done.
            true => self.finish(handled.fault),
            false => self.climb(handled.fault),
        }
    }

    fn is_over(&self, id: FaultId) -> bool {
        let fault = self.history.get(id);
        fault.is_none_or(|fault| fault.verdict.state != FaultState::Confirmed)
    }

    fn is_over_or_runs(&self, id: FaultId) -> bool {
        self.is_over(id) || self.history.get(id).is_some_and(|fault| fault.runs)
    }
}
