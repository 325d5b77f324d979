//! What the fault manager wants done is done.

use std::time::Duration;

use system_model::injection::ContainerFailure;
use system_model::rules::{Preload, StopCategory};

use super::{StandIn, State};
use crate::observation::{ActionOutcome, Observation};
use crate::plan::{Action, ActionId, PlannedAction};
use crate::what_if::Recoveries;

/// One thing to do with a component, between two steps of its executor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Order {
    pub action: Option<ActionId>,
    component: usize,
    task: Task,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Task {
    Reset,
    Replace(usize),
    Adapt,
    Stop,
    Destroy,
    EmergencyStop,
}

impl StandIn<'_> {
    pub(super) fn act(&mut self, planned: &PlannedAction) {
        let (component, task) = match planned.action {
            Action::Reset { component, .. } => (component, Task::Reset),
            Action::Replace {
                component,
                secondary,
                ..
            } => (component, Task::Replace(secondary)),
            // What a tree comes to nobody can know; supposed is that it does what it is for.
            Action::Handle { component, .. } => (component, Task::Reset),
            Action::Adapt { component } => (component, Task::Adapt),
            Action::Stop { component } => (component, Task::Stop),
            Action::Destroy { component } => (component, Task::Destroy),
            Action::EmergencyStop => return self.stop_in_emergency(planned.id),
        };
        if component >= self.components.len() {
            // A behaviour tree, whose ticks are not played: what is asked of it is done.
            let outcome = ActionOutcome::Done {
                incarnation: 0,
                note: String::new(),
            };
            let action = planned.id;
            return self.observe(Observation::Ended { action, outcome });
        }
        let order = Order {
            action: Some(planned.id),
            component,
            task,
        };
        if planned.not_before > self.now {
            self.later.push((planned.not_before, order));
        } else {
            self.give(order);
        }
    }

    pub(super) fn give(&mut self, order: Order) {
        let mut executors = self.executors.iter_mut();
        if let Some(executor) = executors.find(|one| one.members.contains(&order.component)) {
            executor.orders.push_back(order);
        }
    }

    /// The fault manager sees what happened, and what it asks is done at once.
    pub(super) fn serve(&mut self) {
        self.attend();
        while let Some(index) = (self.executors.iter()).position(|one| !one.orders.is_empty()) {
            while let Some(order) = self.executors[index].orders.pop_front() {
                self.obey(&order);
                self.attend();
            }
            self.goes_on(index);
        }
    }

    fn obey(&mut self, order: &Order) {
        let component = order.component;
        let outcome = match order.task {
            Task::Reset | Task::Replace(_) => self.recover(component, order.task),
            // Whether there is another way only the robot knows; it is supposed that there is.
            Task::Adapt => match self.assumptions.recoveries {
                Recoveries::Fail => Err("supposed to fail".to_owned()),
                _ => Ok(()),
            },
            Task::Stop => {
                let own = &mut self.components[component];
                if own.state == State::Active {
                    own.state = State::Inactive;
                }
                Ok(())
            }
            Task::Destroy => {
                self.components[component].state = State::Destroyed;
                Ok(())
            }
            Task::EmergencyStop => return self.stop_actuator(component, order.action),
        };
        self.end(order.action, component, outcome);
    }

    /// Who was in ERROR, and has worked since its last recovery, works at once; any other one with
    /// its next cycle.
    fn recover(&mut self, index: usize, task: Task) -> Result<(), String> {
        let fails = self.assumptions.recoveries == Recoveries::Fail;
        if fails || self.handling_fails(index, task) {
            let component = &mut self.components[index];
            if fails && component.state == State::Active {
                component.state = State::Error;
            }
            return Err("supposed to fail".to_owned());
        }
        let component = &mut self.components[index];
        let at_once = component.state == State::Error && !component.unproven;
        component.state = State::Active;
        component.incarnation += 1;
        component.hanging_until = Duration::ZERO;
        component.unproven = true;
        if let Task::Replace(secondary) = task {
            component.secondary = Some(secondary);
        }
        self.begin_anew(index);
        self.begin_models_anew(index);
        if self.components[index].is_passive() {
            self.prove(index);
        } else if at_once {
            self.execute(index);
        }
        Ok(())
    }

    /// Whether a supposed fault of the handling hits this recovery. A library is loaded where no
    /// standby waits.
    fn handling_fails(&mut self, index: usize, task: Task) -> bool {
        let rules = &self.manager.system.components[index].rules;
        let prepared = match (task, self.components[index].secondary) {
            (Task::Replace(secondary), _) | (Task::Reset, Some(secondary)) => {
                rules.secondaries[secondary].preload != Preload::Cold
            }
            _ => rules
                .standby
                .as_ref()
                .is_some_and(|rule| rule.value != Preload::Cold),
        };
        self.misfortune
            .takes(index, ContainerFailure::RecoveryFails)
            || (!prepared
                && self
                    .misfortune
                    .takes(index, ContainerFailure::LibraryMissing))
    }

    /// Every actuator is told, and works once more.
    fn stop_in_emergency(&mut self, action: ActionId) {
        let actuators: Vec<usize> = (0..self.components.len())
            .filter(|index| self.category(*index).is_some())
            .collect();
        self.emergency = Some((action, actuators.len()));
        if actuators.is_empty() {
            self.end(Some(action), 0, Ok(()));
        }
        for component in actuators {
            self.give(Order {
                action: Some(action),
                component,
                task: Task::EmergencyStop,
            });
        }
    }

    fn category(&self, component: usize) -> Option<StopCategory> {
        let rules = &self.manager.system.components[component].rules;
        rules.actuator.as_ref().map(|rule| rule.value.stop_category)
    }

    fn stop_actuator(&mut self, component: usize, action: Option<ActionId>) {
        self.execute(component);
        if self.category(component) == Some(StopCategory::PowerOff) {
            self.power_off(component);
        }
        if let Some((stop, waiting)) = &mut self.emergency
            && Some(*stop) == action
        {
            *waiting = waiting.saturating_sub(1);
            if *waiting == 0 {
                self.end(action, component, Ok(()));
            }
        }
    }

    fn power_off(&mut self, component: usize) {
        let own = &mut self.components[component];
        if own.state == State::Active {
            own.state = State::Inactive;
        }
    }

    /// In an emergency stop actuators whose motion is stopped under control first lose their power
    /// in the end.
    pub(super) fn power_off_actuators(&mut self) {
        if self.manager.is_emergency() {
            for component in 0..self.components.len() {
                if self.category(component) == Some(StopCategory::ControlledThenOff) {
                    self.power_off(component);
                }
            }
        }
    }

    fn end(&mut self, action: Option<ActionId>, component: usize, outcome: Result<(), String>) {
        let Some(action) = action else { return };
        let outcome = match outcome {
            Ok(()) => ActionOutcome::Done {
                incarnation: self.components[component].incarnation,
                note: String::new(),
            },
            Err(reason) => ActionOutcome::Failed { reason },
        };
        self.observe(Observation::Ended { action, outcome });
    }
}
