//! What the fault manager decides is carried out: orders to executors, verdicts on record, the
//! emergency stop.

use std::time::Duration;

use fault_manager::{
    Action, ActionId, ActionOutcome, Effect, Evidence, FaultManager, Observation, PlannedAction,
};
use system_model::specification::ManagerPort;

use super::orders::{Order, Task};
use super::supervisor::{Core, Supervisor};
use crate::clock::nanoseconds;

impl Supervisor {
    pub(super) fn carry_out(&self, core: &mut Core, effect: Effect) {
        match effect {
            Effect::Act(planned) => self.act(core, &planned),
            Effect::Abandon(action) => core.later.retain(|(_, order)| order.action != Some(action)),
            // Asked for by itself: see `Self::write_records`.
            Effect::Record(_) => {}
            Effect::Rearm => {
                for actuator in self.emergency.rearm(self.environment.clock.now_ns()) {
                    self.give(Order {
                        action: None,
                        component: actuator,
                        task: Task::Resume,
                    });
                }
            }
        }
    }

    fn act(&self, core: &mut Core, planned: &PlannedAction) {
        let now_ns = self.environment.clock.now_ns();
        let (component, task) = match &planned.action {
            Action::EmergencyStop => return self.stop_in_emergency(core, planned.id, now_ns),
            Action::Reset {
                component,
                checkpoint_before,
            } => (
                *component,
                Task::Reset {
                    checkpoint_before_ns: checkpoint_before.map(nanoseconds),
                },
            ),
            Action::Replace {
                component,
                secondary,
                checkpoint_before,
            } => (
                *component,
                Task::Replace {
                    variant: secondary + 1,
                    checkpoint_before_ns: checkpoint_before.map(nanoseconds),
                },
            ),
            Action::Handle { tree, within, .. } => {
                let task = Task::Handle {
                    until_ns: now_ns.saturating_add(nanoseconds(*within)),
                };
                (*tree, task)
            }
            Action::Adapt { component } => {
                let requests = &self.environment.adaptation_requests;
                if !requests.ask(*component, planned.id) {
                    let reason = "nobody watches over its task".to_owned();
                    self.failed(planned.id, reason);
                }
                return;
            }
            Action::Stop { component } => (*component, Task::Stop),
            Action::Destroy { component } => (*component, Task::Destroy),
        };
        if let Some(limit) = hurry(&core.manager, planned) {
            self.orders[component].hurry(limit.into());
        }
        let order = Order {
            action: Some(planned.id),
            component,
            task,
        };
        let not_before_ns = nanoseconds(planned.not_before);
        if not_before_ns > now_ns {
            core.later.push((not_before_ns, order));
        } else {
            self.give(order);
        }
    }

    /// Safe commands at once, from this thread; then each actuator by its category.
    fn stop_in_emergency(&self, core: &mut Core, action: ActionId, now_ns: u64) {
        let stops = self.emergency.engage(action);
        self.raise(core, ManagerPort::EmergencyStop);
        if stops.is_empty() {
            self.ended(action, "no component is declared an actuator");
        }
        for stop in stops {
            self.give(Order {
                action: Some(action),
                component: stop.component,
                task: Task::EmergencyStop {
                    power_off: stop.power_off_after == Some(Duration::ZERO),
                },
            });
            if let Some(after) = stop.power_off_after.filter(|after| !after.is_zero()) {
                let order = Order {
                    action: None,
                    component: stop.component,
                    task: Task::Stop,
                };
                core.later.push((now_ns + nanoseconds(after), order));
            }
        }
    }

    fn ended(&self, action: ActionId, note: &str) {
        self.environment.observations.report(Observation::Ended {
            action,
            outcome: ActionOutcome::Done {
                incarnation: 0,
                note: note.to_owned(),
            },
        });
    }

    fn failed(&self, action: ActionId, reason: String) {
        let outcome = ActionOutcome::Failed { reason };
        let observation = Observation::Ended { action, outcome };
        self.environment.observations.report(observation);
    }

    pub(super) fn give(&self, order: Order) {
        let action = order.action;
        let orders = self.orders.get(order.component);
        let given = orders.is_some_and(|orders| orders.give(order));
        if let (false, Some(action)) = (given, action) {
            self.failed(action, "too many orders wait for its executor".to_owned());
        }
    }
}

/// A component that has missed its heartbeats may be hanging long before its deadline: how long a
/// callback of its executor may take while the order waits.
fn hurry(manager: &FaultManager, planned: &PlannedAction) -> Option<Duration> {
    match manager.verdict(planned.fault)?.evidence {
        Evidence::Heartbeat { period_ms, .. } => Some(Duration::from_secs_f64(period_ms / 1e3)),
        _ => None,
    }
}
