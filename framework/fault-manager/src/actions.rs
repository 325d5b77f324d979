//! Plans and actions: asked for, noted in the verdict, ended.

use std::time::Duration;

use crate::manager::FaultManager;
use crate::observation::ActionOutcome;
use crate::plan::{Action, ActionId, Effect, PlannedAction};
use crate::state::{Task, Work};
use crate::verdict::FaultId;
use crate::wording;

impl FaultManager {
    /// Has an action done for a fault.
    pub(crate) fn act(
        &mut self,
        id: FaultId,
        action: Action,
        not_before: Duration,
        deadline: Duration,
    ) -> ActionId {
        self.last_action += 1;
        let number = ActionId(self.last_action);
        if let Some(fault) = self.history.get_mut(id) {
            fault.begin_action(number, wording::action(&self.system, &action));
            self.changed.insert(id);
        }
        self.effects.push(Effect::Act(PlannedAction {
            id: number,
            fault: id,
            action,
            not_before,
            deadline: Some(deadline),
        }));
        number
    }

    /// Adds to the plan of a fault.
    pub(crate) fn plan(&mut self, id: FaultId, sentence: String) {
        let now = self.now;
        if let Some(fault) = self.history.get_mut(id) {
            fault.plan(sentence, now);
            self.changed.insert(id);
        }
    }

    /// Notes what became of an action.
    pub(crate) fn note_outcome(
        &mut self,
        id: FaultId,
        action: ActionId,
        outcome: &'static str,
        note: String,
    ) {
        if let Some(fault) = self.history.get_mut(id) {
            fault.record_outcome(action, outcome, note);
            self.changed.insert(id);
        }
    }

    /// Nothing more comes of an action; with the last one the handling of its fault has ended, unless
    /// something follows.
    pub(crate) fn action_over(&mut self, id: FaultId) {
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        fault.pending = fault.pending.saturating_sub(1);
        if fault.pending == 0 && fault.waits.is_none() {
            self.finish(id);
        }
    }

    /// An action has ended.
    pub(crate) fn ended(&mut self, action: ActionId, outcome: ActionOutcome) {
        if self.emergency_ended(action, &outcome) || self.tree_ended(action, &outcome) {
            return;
        }
        let under_way = |work: &Work| work.id == action && work.ended.is_none();
        let component = self
            .components
            .iter()
            .position(|state| state.work.as_ref().is_some_and(under_way));
        let Some(component) = component else {
            return;
        };
        let task = self.components[component]
            .work
            .as_ref()
            .map(|work| work.task);
        match (task, outcome) {
            (Some(Task::Recover), ActionOutcome::Done { incarnation, note }) => {
                self.recovered(component, incarnation, note);
            }
            (Some(Task::Recover | Task::Adapt), ActionOutcome::Failed { reason }) => {
                self.recovery_failed(component, "failed", reason);
            }
            (Some(Task::Adapt), ActionOutcome::Done { note, .. }) => self.adapted(component, note),
            (Some(Task::Stop | Task::Destroy), ActionOutcome::Done { note, .. }) => {
                self.stop_ended(component, "done", note);
            }
            (Some(Task::Stop | Task::Destroy), ActionOutcome::Failed { reason }) => {
                self.stop_ended(component, "failed", reason);
            }
            (None, _) => {}
        }
    }
}
