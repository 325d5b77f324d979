//! Stops: exactly what depends comes down, dependents before what they need.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use system_model::fault::FaultKind;

use crate::graph::{Demand, Level};
use crate::manager::FaultManager;
use crate::plan::{Action, Effect};
use crate::state::{Condition, Down, Task, Work};
use crate::verdict::{FaultId, FaultState};
use crate::wording;

/// A stop that has not ended by then has failed. The container gives a component three seconds to
/// stop and says so itself; its answer comes first.
pub(crate) const STOP_DEADLINE: Duration = Duration::from_secs(4);

/// What is stopped for a fault, before what depends on it.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Reach {
    Component(usize),
    Application(usize),
}

impl FaultManager {
    /// Stops a component or an application, and what needs it.
    pub(crate) fn stop(&mut self, id: FaultId, reach: Reach) {
        let mut chosen = BTreeSet::new();
        match reach {
            Reach::Component(component) => {
                chosen.insert(component);
            }
            Reach::Application(application) => {
                let stopped = &self.system.applications[application];
                let members = stopped.members.clone().chain(stopped.trees.clone());
                chosen.extend(members.filter(|member| {
                    let down = self.components[*member].down;
                    down.is_none_or(|down| down.condition == Condition::Lost)
                }));
                let sentence = wording::application(&stopped.name);
                self.plan(id, sentence);
            }
        }
        self.bring_down(id, &chosen);
    }

    /// A component is in ERROR and stays so: what needs it is stopped.
    pub(crate) fn lose(&mut self, id: FaultId) {
        let Some(component) = self.history.get(id).map(|fault| fault.component) else {
            return;
        };
        self.components[component].down = Some(Down {
            condition: Condition::Lost,
            by: id,
        });
        self.bring_down(id, &BTreeSet::new());
    }

    /// An operator has started a component again; not for long if it lacks what it needs.
    pub(crate) fn restarted(&mut self, component: usize) {
        let Some(down) = self.components[component].down.take() else {
            return;
        };
        self.components[component].ladder.worked();
        let healed = self.history.which(|fault| {
            fault.component == component && fault.verdict.state == FaultState::Confirmed
        });
        self.come_back(component, healed);
        self.bring_down(down.by, &BTreeSet::new());
    }

    /// Stops these components and everything that lacks what it needs.
    fn bring_down(&mut self, id: FaultId, chosen: &BTreeSet<usize>) {
        let mut levels = self.levels();
        for component in chosen {
            levels[*component] = levels[*component].max(Level::Stopped);
        }
        let demands = self.graph.spread(&mut levels);
        let all = chosen.iter().chain(demands.keys()).copied().collect();
        for component in self.graph.stop_order(&all) {
            self.bring_one_down(id, component, &demands);
        }
        let idle = |fault: &crate::life::Fault| fault.pending == 0 && fault.handled_at.is_none();
        if self.history.get(id).is_some_and(idle) {
            self.finish(id);
        }
    }

    fn bring_one_down(&mut self, id: FaultId, component: usize, demands: &BTreeMap<usize, Demand>) {
        // Its own tree may stop it: that is part of how the fault is handled.
        let by_other =
            (self.history.get(id)).is_none_or(|fault| fault.kind != FaultKind::OperatorOrder);
        let demand = demands.get(&component);
        let destroy = demand.is_some_and(|demand| demand.level == Level::Destroyed);
        let action = if destroy {
            Action::Destroy { component }
        } else {
            Action::Stop { component }
        };
        let mut sentence = wording::action(&self.system, &action);
        if let Some(demand) = demand {
            sentence = wording::dependent(&sentence, &demand.wanted);
        }
        self.plan(id, sentence);
        let overtaken = self.components[component].work.take();
        let abandoned = overtaken.as_ref().map(|work| Effect::Abandon(work.id));
        self.effects.extend(abandoned);
        self.begin_stop(id, component, action);
        if let Some(work) = overtaken {
            let note = wording::overtaken(id);
            self.note_outcome(work.fault, work.id, "abandoned", note);
            self.action_over(work.fault);
        }
        if by_other {
            self.overtake_tree(component, id);
        }
        self.settle_for(id, component);
    }

    /// What was to be done for a component that is stopped for a fault need not be done any more.
    fn settle_for(&mut self, id: FaultId, component: usize) {
        let waiting = self
            .history
            .which(|fault| fault.component == component && fault.waits.is_some());
        for other in waiting {
            self.plan(other, wording::stopped_for(id));
            self.give_up_waiting(other);
        }
        for symptom in std::mem::take(&mut self.components[component].queue) {
            self.judge(symptom);
        }
    }

    fn begin_stop(&mut self, id: FaultId, component: usize, action: Action) {
        let (task, condition) = match action {
            Action::Destroy { .. } => (Task::Destroy, Condition::Destroyed),
            _ => (Task::Stop, Condition::Stopped),
        };
        let deadline = self.now.saturating_add(STOP_DEADLINE);
        let number = self.act(id, action, self.now, deadline);
        let state = &mut self.components[component];
        state.down = Some(Down { condition, by: id });
        state.work = Some(Work {
            id: number,
            fault: id,
            task,
            deadline,
            ended: None,
            worked: None,
        });
    }

    /// A stop has ended. One that failed is followed by the destruction of the component; one that
    /// cannot even be destroyed counts as gone.
    pub(crate) fn stop_ended(&mut self, component: usize, outcome: &'static str, note: String) {
        let Some(work) = self.components[component].work.take() else {
            return;
        };
        self.note_outcome(work.fault, work.id, outcome, note);
        if work.task == Task::Stop && outcome != "done" {
            let action = Action::Destroy { component };
            self.plan(work.fault, wording::action(&self.system, &action));
            self.begin_stop(work.fault, component, action);
        }
        self.action_over(work.fault);
    }
}
