//! An executor carries out an order of the fault manager, between two steps of its cycle.

use std::time::Duration;

use fault_manager::{ActionId, ActionOutcome, Observation};
use system_model::injection::ContainerFailure;
use system_model::life_cycle::{LifeCycleState, Operation};
use system_model::specification::ExecutionKind;

use super::recovery::{Recovered, replace, reset, words};
use super::{Order, Supervisor, Task};
use crate::component::{Component, ComponentCell};
use crate::lane::Lane;

/// How long an executor waits for a component that another thread is inside of by a service call:
/// as long as such a call may take by default.
const ENTER_LIMIT: Duration = Duration::from_secs(1);

/// What was done, in words for who has time to read them.
enum Outcome {
    Recovered(Recovered),
    Other(String),
}

/// Carries an order out, and reports how it ended; whether the component was recovered by it. Who
/// was recovered works before anything is told: `updates` says whether its `onUpdated` does not
/// come by itself in this cycle.
pub fn obey(
    order: &Order,
    cell: &ComponentCell,
    kind: ExecutionKind,
    updates: bool,
    supervisor: &Supervisor,
    lane: &Lane,
) -> bool {
    let Some(mut component) = cell.enter(lane.token(), ENTER_LIMIT) else {
        if let Task::Tap { .. } = order.task {
            supervisor.notice("a fault cannot be injected: a service call is inside its component");
        }
        let busy = Err("a service call is inside it".to_owned());
        end(order.action, supervisor, busy, 0);
        return false;
    };
    // One that fails again and again waits for its next cycle, so that what disturbs it may pass:
    // at once works who was in ERROR, and has worked since its last recovery.
    let at_once = component.state() == LifeCycleState::Error && !component.is_unproven();
    let result = perform(order, &mut component, supervisor, lane);
    let recovered = matches!(result, Ok(Outcome::Recovered(_)));
    let incarnation = component.incarnation();
    if recovered {
        component.expect_proof();
        work_at_once(&mut component, kind, at_once, updates, supervisor, lane);
    }
    drop(component);
    let result = result.map(|outcome| match outcome {
        Outcome::Recovered(recovered) => recovered.to_string(),
        Outcome::Other(note) => note,
    });
    end(order.action, supervisor, result, incarnation);
    recovered
}

/// The thread was lost while it carried an order out.
pub fn lost(action: ActionId, supervisor: &Supervisor) {
    let reason = "its thread was lost in the C library meanwhile".to_owned();
    end(Some(action), supervisor, Err(reason), 0);
}

fn perform(
    order: &Order,
    component: &mut Component,
    supervisor: &Supervisor,
    lane: &Lane,
) -> Result<Outcome, String> {
    let loss = lane.loss();
    let Some(standbys) = supervisor.standbys(order.component) else {
        return Err("there is no such component".to_owned());
    };
    let recovers = matches!(order.task, Task::Reset { .. } | Task::Replace { .. });
    let injections = &supervisor.environment().injections;
    if recovers && injections.fails(order.component, ContainerFailure::RecoveryFails) {
        return Err("injected failure of the recovery".to_owned());
    }
    let done = match &order.task {
        Task::Reset {
            checkpoint_before_ns,
        } => {
            return reset(component, standbys, *checkpoint_before_ns, loss).map(Outcome::Recovered);
        }
        Task::Replace {
            variant,
            checkpoint_before_ns,
        } => {
            return replace(component, standbys, *variant, *checkpoint_before_ns, loss)
                .map(Outcome::Recovered);
        }
        Task::Stop => stop(component, lane),
        Task::Destroy => destroy(component, lane),
        Task::EmergencyStop { power_off } => {
            stop_actuator(order, component, *power_off, supervisor, lane);
            Ok(String::new())
        }
        Task::Resume => match component.state() {
            LifeCycleState::Inactive => component
                .operate(Operation::Start, loss)
                .map(|()| String::new())
                .map_err(|error| words("onStart", &error)),
            _ => Ok(String::new()),
        },
        Task::Handle { .. } => Err("a component is no behaviour tree".to_owned()),
        Task::Tap { port } => {
            component.services_mut().tap(*port);
            Ok(String::new())
        }
    };
    done.map(Outcome::Other)
}

/// A component that is in ERROR or was never started runs no more than a stopped one.
fn stop(component: &mut Component, lane: &Lane) -> Result<String, String> {
    if !component.is_active() {
        return Ok(format!("it was {}", component.state()));
    }
    component
        .operate(Operation::Stop, lane.loss())
        .map(|()| String::new())
        .map_err(|error| words("onStop", &error))
}

fn destroy(component: &mut Component, lane: &Lane) -> Result<String, String> {
    if component.is_active() {
        // That it fails is on record; it is destroyed all the same.
        let _recorded = component.operate(Operation::Stop, lane.loss());
    }
    component
        .operate(Operation::Destroy, lane.loss())
        .map(|()| String::new())
        .map_err(|error| words("onDestroy", &error))
}

/// Tells an actuator of the emergency and lets it work once: its command ports read their safe
/// values by now, and it is not to wait for its next period.
fn stop_actuator(
    order: &Order,
    component: &mut Component,
    power_off: bool,
    supervisor: &Supervisor,
    lane: &Lane,
) {
    let now_ns = supervisor.environment().clock.now_ns();
    if component.is_active() {
        component.tell_emergency_stop(lane.loss());
    }
    if component.is_active() {
        component.execute(now_ns, lane.loss());
    }
    if power_off {
        // That it fails is on record; the stop goes on with the other actuators.
        let _recorded = stop(component, lane);
    }
    if let Some(action) = order.action
        && supervisor.emergency().answered(action)
    {
        let note = "every actuator was told".to_owned();
        finish(Some(action), supervisor, Ok(note), 0);
    }
}

/// A recovered component works at once, if it is to. A passive one works whenever it is asked.
fn work_at_once(
    component: &mut Component,
    kind: ExecutionKind,
    at_once: bool,
    updates: bool,
    supervisor: &Supervisor,
    lane: &Lane,
) {
    if kind == ExecutionKind::Passive {
        component.prove();
        return;
    }
    if at_once {
        let now_ns = supervisor.environment().clock.now_ns();
        component.execute(now_ns, lane.loss());
        if updates && component.is_active() {
            component.updated(lane.loss());
        }
    }
}

/// Another standby for the one that was used: now where time is simulated, else in the background.
pub fn refill(component: usize, supervisor: &Supervisor, lane: &Lane) {
    if supervisor.environment().clock.is_simulated() {
        if let Err(reason) = supervisor.prepare_standbys(component, lane.loss()) {
            supervisor.notice(&reason);
        }
    } else {
        supervisor.want_standbys(component);
    }
}

/// The emergency stop ends when the last actuator has answered, all else when it is done.
fn end(
    action: Option<ActionId>,
    supervisor: &Supervisor,
    result: Result<String, String>,
    incarnation: u32,
) {
    let is_emergency = action.is_some_and(|action| supervisor.emergency().is_for(action));
    if !is_emergency {
        finish(action, supervisor, result, incarnation);
    }
}

fn finish(
    action: Option<ActionId>,
    supervisor: &Supervisor,
    result: Result<String, String>,
    incarnation: u32,
) {
    let Some(action) = action else { return };
    let outcome = match result {
        Ok(note) => ActionOutcome::Done { incarnation, note },
        Err(reason) => ActionOutcome::Failed { reason },
    };
    supervisor
        .environment()
        .observations
        .report(Observation::Ended { action, outcome });
}
