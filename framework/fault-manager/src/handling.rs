//! Recoveries: the ladder is climbed, actions end, components work again.

use std::time::Duration;

use system_model::rules::{ApplicationSeverity, ComponentSeverity};

use crate::ladder::Rung;
use crate::life::Wait;
use crate::manager::FaultManager;
use crate::plan::{Action, Effect};
use crate::state::{Condition, Down, Task, Work};
use crate::stopping::Reach;
use crate::verdict::{Cause, FaultId, FaultState};
use crate::wording;

/// A decision of the self-adaptation has bounds of its own, that add up to less: this is for one of
/// which nothing is heard any more.
const ADAPTATION_DEADLINE: Duration = Duration::from_secs(30);

impl FaultManager {
    /// Plans what the severity of a root cause asks for.
    pub(crate) fn decide(&mut self, id: FaultId) {
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        fault.begin_debounce_anew();
        let (component, runs) = (fault.component, fault.runs);
        match fault.terms.severity {
            ComponentSeverity::Ignore => {
                self.plan(id, wording::RECORD_ONLY.to_owned());
                self.finish(id);
                if !runs {
                    self.lose(id);
                }
            }
            ComponentSeverity::Reset => self.climb(id),
            ComponentSeverity::Stop => self.stop(id, Reach::Component(component)),
            ComponentSeverity::Emergency => self.raise_emergency(id),
        }
    }

    /// Plans the next rung for a fault's component.
    pub(crate) fn climb(&mut self, id: FaultId) {
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        if self.emergency.is_some() {
            fault.waits = Some(Wait::Clearance);
            self.plan(id, wording::WAIT.to_owned());
            return;
        }
        let index = fault.component;
        let before = fault.first_symptom();
        if let Some(other) = self.handled_by_tree(index).filter(|other| *other != id) {
            // What the tree does may be all that is needed: judged anew when it has ended.
            if let Some(fault) = self.history.get_mut(id) {
                fault.waits = Some(Wait::Root(other));
                self.changed.insert(id);
            }
            return;
        }
        let checkpoint_before = self.checkpoint_before(index, before);
        let component = &self.system.components[index];
        let rule = component.fault;
        match self.components[index].ladder.climb(component, self.now) {
            Rung::Reset {
                attempt,
                not_before,
            } => {
                let name = &component.name;
                let sentence = wording::reset(name, attempt, rule.retry_max, rule.window);
                let action = Action::Reset {
                    component: index,
                    checkpoint_before,
                };
                self.recover(id, action, sentence, not_before);
            }
            Rung::Replace(secondary) => {
                let action = Action::Replace {
                    component: index,
                    secondary,
                    checkpoint_before,
                };
                let sentence = wording::action(&self.system, &action);
                self.recover(id, action, sentence, self.now);
            }
            Rung::HandleByTree => self.handle_by_tree(id, index),
            Rung::Adapt => self.adapt(id, index),
            Rung::Exhausted => match rule.severity {
                ApplicationSeverity::Ignore => self.stop(id, Reach::Component(index)),
                ApplicationSeverity::Local => {
                    self.stop(id, Reach::Application(component.application));
                }
                ApplicationSeverity::Global => self.raise_emergency(id),
            },
        }
    }

    /// The task is to go on without a component.
    fn adapt(&mut self, id: FaultId, component: usize) {
        let action = Action::Adapt { component };
        self.plan(id, wording::action(&self.system, &action));
        let deadline = self.now.saturating_add(ADAPTATION_DEADLINE);
        let number = self.act(id, action, self.now, deadline);
        self.components[component].work = Some(Work {
            id: number,
            fault: id,
            task: Task::Adapt,
            deadline,
            ended: None,
            worked: None,
        });
    }

    /// The task is done without a component: it is not needed, and neither is what it needs.
    pub(crate) fn adapted(&mut self, component: usize, note: String) {
        let Some(work) = self.components[component].work.take() else {
            return;
        };
        self.note_outcome(work.fault, work.id, "done", note);
        self.components[component].queue.clear();
        self.components[component].down = Some(Down {
            condition: Condition::Unneeded,
            by: work.fault,
        });
        self.action_over(work.fault);
    }

    pub(crate) fn recover(
        &mut self,
        id: FaultId,
        action: Action,
        sentence: String,
        not_before: Duration,
    ) {
        let Some(index) = action.component() else {
            return;
        };
        self.plan(id, sentence);
        let allowed = self.system.components[index].recovery_deadline;
        let deadline = not_before.saturating_add(allowed);
        let number = self.act(id, action, not_before, deadline);
        self.components[index].work = Some(Work {
            id: number,
            fault: id,
            task: Task::Recover,
            deadline,
            ended: None,
            worked: None,
        });
    }

    /// A recovery was carried out. What was queued of the old instance belongs to it; what the new
    /// one could not live through ends it.
    pub(crate) fn recovered(&mut self, component: usize, incarnation: u32, note: String) {
        let state = &mut self.components[component];
        state.incarnation = state.incarnation.max(incarnation);
        let Some(work) = state.work.as_mut() else {
            return;
        };
        work.ended = Some(incarnation);
        let (id, fault) = (work.id, work.fault);
        let worked = work.worked.is_some_and(|worked| worked >= incarnation);
        self.note_outcome(fault, id, "done", note);
        let queue = std::mem::take(&mut self.components[component].queue);
        for symptom in queue {
            let same = |work: &Work| work.id == id;
            let under_way = self.components[component].work.as_ref().is_some_and(same);
            if under_way && symptom.incarnation < incarnation {
                self.judge(symptom);
            } else {
                self.symptom(symptom);
            }
        }
        let periodic = self.system.components[component].periodic;
        let work = self.components[component].work.as_ref();
        if work.is_some_and(|work| work.id == id) && (worked || !periodic) {
            self.works_again(component);
        }
    }

    /// An attempt has failed or took too long: the next rung at once.
    pub(crate) fn recovery_failed(
        &mut self,
        component: usize,
        outcome: &'static str,
        reason: String,
    ) {
        let Some(work) = self.components[component].recovery().cloned() else {
            return;
        };
        self.note_outcome(work.fault, work.id, outcome, reason);
        for symptom in std::mem::take(&mut self.components[component].queue) {
            self.judge(symptom);
        }
        let same = self.components[component].recovery();
        if same.is_none_or(|same| same.id != work.id) {
            return;
        }
        self.components[component].work = None;
        if let Some(fault) = self.history.get_mut(work.fault) {
            fault.pending = fault.pending.saturating_sub(1);
            fault.runs = false;
        }
        self.climb(work.fault);
    }

    /// A component has not come to the end of its action in time.
    pub(crate) fn overdue(&mut self, component: usize) {
        let Some(work) = self.components[component].work.clone() else {
            return;
        };
        self.effects.push(Effect::Abandon(work.id));
        let reason = match work.ended {
            Some(_) => "no cycle was completed before the deadline",
            None => "not ended before the deadline",
        };
        match work.task {
            Task::Recover | Task::Adapt => {
                self.recovery_failed(component, "overdue", reason.to_owned())
            }
            Task::Stop | Task::Destroy => {
                self.stop_ended(component, "overdue", reason.to_owned());
            }
        }
    }

    /// A component has completed a cycle after an action.
    pub(crate) fn works(&mut self, component: usize, incarnation: u32) {
        let Some(state) = self.components.get_mut(component) else {
            return;
        };
        let known = state.incarnation;
        state.incarnation = known.max(incarnation);
        match (&mut state.work, state.down) {
            (Some(work), None) => match work.ended {
                Some(new) if incarnation >= new => self.works_again(component),
                Some(_) => {}
                None => work.worked = work.worked.max(Some(incarnation)),
            },
            (Some(_), Some(_)) => {}
            (None, Some(_)) if incarnation >= known => self.restarted(component),
            (None, Some(_)) => {}
            (None, None) => self.revived(component, incarnation),
        }
    }

    /// A recovery has succeeded: its fault has healed, and all that belonged to it.
    fn works_again(&mut self, component: usize) {
        let Some(work) = self.components[component].work.take() else {
            return;
        };
        self.components[component].ladder.worked();
        self.action_over(work.fault);
        let owner = Cause::ConsequenceOf(work.fault);
        let healed = self.history.which(|fault| {
            let own = fault.verdict.id == work.fault;
            let part =
                fault.component == component && (fault.verdict.cause == owner || !fault.runs);
            own || part
        });
        self.come_back(component, healed);
        for symptom in std::mem::take(&mut self.components[component].queue) {
            self.symptom(symptom);
        }
    }

    /// Faults of a component that works again heal, and what was seen of its old instance, but was
    /// too little for a fault, is forgotten.
    pub(crate) fn come_back(&mut self, component: usize, healed: Vec<FaultId>) {
        for id in healed {
            if let Some(fault) = self.history.get_mut(id) {
                fault.runs = true;
                if fault.waits.is_some() {
                    self.give_up_waiting(id);
                }
                self.heal(id);
            }
        }
        for id in self.history.which(|fault| {
            fault.component == component && fault.verdict.state == FaultState::Prefailed
        }) {
            self.history.remove(id);
        }
    }

    /// A component that was in ERROR works again, by an operator's doing.
    fn revived(&mut self, component: usize, incarnation: u32) {
        let healed = self.history.which(|fault| {
            let older = fault.verdict.incarnation < incarnation;
            fault.component == component && !fault.runs && older
        });
        if !healed.is_empty() {
            self.components[component].ladder.worked();
            self.come_back(component, healed);
        }
    }
}
