//! What an operator orders for one component: it goes the same way as what the rules want done, and
//! is on record as a verdict of its own.

use std::time::Duration;

use system_model::fault::FaultKind;
use system_model::rules::{Arming, ComponentSeverity, Confirmation};

use crate::detectors::Terms;
use crate::evidence::Evidence;
use crate::graph::Level;
use crate::life::Fault;
use crate::manager::FaultManager;
use crate::observation::{DetectorKind, OperatorOrder, Symptom};
use crate::plan::Action;
use crate::state::{Condition, Task};
use crate::stopping::Reach;
use crate::verdict::{FaultId, FaultState};
use crate::wording;

impl FaultManager {
    /// Why an order makes no sense now, with what to do instead; none if it would be carried out.
    /// `component` is the index of a component.
    pub fn refusal(&self, component: usize, order: OperatorOrder) -> Option<String> {
        let Some(state) = self.components.get(component) else {
            return Some("there is no such component".to_owned());
        };
        if !self.running {
            return Some("the applications are being brought up; try again".to_owned());
        }
        let name = &self.system.components[component].name;
        if order == OperatorOrder::Stop {
            return match state.down.map(|down| down.condition) {
                Some(Condition::Stopped) => Some(format!("{name} is stopped already")),
                Some(Condition::Destroyed) => Some(format!("{name} is destroyed already")),
                _ => None,
            };
        }
        // What will never make sense before what does not at the moment.
        if let OperatorOrder::Replace { secondary } = order
            && let Some(reason) = self.unknown_secondary(component, secondary)
        {
            return Some(reason);
        }
        if self.emergency.is_some() {
            return Some(format!(
                "an emergency stop is latched, {name} may not move; \
                 end it with 'steadfast fault clear --all' first"
            ));
        }
        if let Some(work) = &state.work {
            let doing = match work.task {
                Task::Recover => "recovered",
                Task::Adapt => "done without",
                Task::Stop | Task::Destroy => "stopped",
            };
            let fault = work.fault.0;
            return Some(format!(
                "{name} is being {doing} for fault {fault}; try again when that is over"
            ));
        }
        let wanted = self.lacks(component)?;
        Some(format!("{name} needs {wanted}; reset that first"))
    }

    /// Carries an order out, unless it makes no sense any more: then nothing happens.
    /// `by`: the index of the behaviour tree that orders it; none for an operator.
    pub(crate) fn ordered(&mut self, component: usize, order: OperatorOrder, by: Option<usize>) {
        if self.refusal(component, order).is_some() {
            return;
        }
        let now = self.now;
        let checkpoint_before = self.checkpoint_before(component, now);
        let action = match order {
            OperatorOrder::Stop => Action::Stop { component },
            OperatorOrder::Reset => Action::Reset {
                component,
                checkpoint_before,
            },
            OperatorOrder::Replace { secondary } => Action::Replace {
                component,
                secondary: secondary.unwrap_or_else(|| self.next_secondary(component)),
                checkpoint_before,
            },
        };
        let sentence = wording::action(&self.system, &action);
        let Some(id) = self.open_order(component, &action, &sentence, by) else {
            return;
        };
        match action {
            Action::Stop { component } => self.stop(id, Reach::Component(component)),
            action => {
                self.lift(component, id);
                let ladder = &mut self.components[component].ladder;
                match action {
                    Action::Replace { secondary, .. } => ladder.replace(secondary),
                    // A tree that handles a fault is on a rung of that very ladder.
                    _ if by.is_none() => ladder.renew(),
                    _ => {}
                }
                self.recover(id, action, sentence, now);
            }
        }
    }

    /// The newest checkpoint before this time is wanted if the rules keep any.
    pub(crate) fn checkpoint_before(&self, component: usize, time: Duration) -> Option<Duration> {
        let resurrect = self.system.components[component].rules.resurrect.as_ref();
        resurrect
            .and_then(|rule| rule.value.backup)
            .map(|_period| time)
    }

    /// The secondary that is next on the ladder; after the last one the first.
    fn next_secondary(&self, component: usize) -> usize {
        let count = self.system.components[component].rules.secondaries.len();
        self.components[component].ladder.next_secondary() % count.max(1)
    }

    /// Puts an order on record: a fault in nothing but that somebody wants something done.
    fn open_order(
        &mut self,
        component: usize,
        action: &Action,
        words: &str,
        by: Option<usize>,
    ) -> Option<FaultId> {
        let detector = self.detectors.find(component, &DetectorKind::Exception)?;
        let severity = match action {
            Action::Stop { .. } => ComponentSeverity::Stop,
            _ => ComponentSeverity::Reset,
        };
        let terms = Terms {
            severity,
            confirmation: Confirmation {
                count: 1,
                within: None,
            },
            latched: false,
            place: None,
            arming: Arming::Running,
        };
        let now = self.now;
        let symptom = Symptom {
            detector,
            incarnation: self.components[component].incarnation.max(1),
            kind: FaultKind::OperatorOrder,
            return_code: 0,
            at: now,
            runs: true,
            evidence: Evidence::Order {
                order: words.to_owned(),
                by: by.map(|tree| self.system.components[tree].name.clone()),
            },
        };
        let id = self.history.number();
        let named = &self.system.components[component];
        let mut fault = Fault::new(id, named, component, terms, symptom);
        fault.take(now, true, now);
        fault.confirm(now);
        self.history.insert(fault);
        self.changed.insert(id);
        Some(id)
    }

    /// A component that is down may work again by this order. What took it down is over when it does.
    fn lift(&mut self, component: usize, order: FaultId) {
        if self.components[component].down.take().is_none() {
            return;
        }
        for id in self.history.which(|fault| {
            fault.component == component && fault.verdict.state == FaultState::Confirmed
        }) {
            if let Some(fault) = self.history.get_mut(id).filter(|_| id != order) {
                fault.runs = false;
            }
        }
    }

    /// What a component needs and does not have.
    fn lacks(&self, component: usize) -> Option<String> {
        let mut levels = self.levels();
        levels[component] = Level::Up;
        let mut demands = self.graph.spread(&mut levels);
        demands.remove(&component).map(|demand| demand.wanted)
    }

    fn unknown_secondary(&self, component: usize, secondary: Option<usize>) -> Option<String> {
        let component = &self.system.components[component];
        let name = &component.name;
        match (component.rules.secondaries.len(), secondary) {
            (0, _) => Some(format!(
                "the rules name no secondary for {name}; \
                 name one by <fault><secondary> in its rules"
            )),
            (count, Some(index)) if index >= count => {
                Some(format!("{name} has no secondary of that name"))
            }
            _ => None,
        }
    }
}
