//! Recovery of one component, on the thread of its executor: in place where the instance can still
//! be called, else by a fresh instance; by the call order of the OPRoS life cycle (Ahn et al. 2012,
//! section 3.4 and figure 9).

use std::fmt;

use system_model::life_cycle::{LifeCycleState, Operation};

use super::standby::Standbys;
use crate::component::{Component, OperationError, Restored};
use crate::guard::Callback;
use crate::guard::loss::Loss;

/// What a person may want to know of a recovery.
#[derive(Debug, Clone, Copy)]
pub struct Recovered {
    /// By what; empty if in place.
    by: &'static str,
    /// What became of its checkpoint; none if none was wanted.
    checkpoint: Option<Restored>,
}

impl fmt::Display for Recovered {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.by)?;
        match self.checkpoint {
            None => Ok(()),
            Some(checkpoint) if self.by.is_empty() => write!(formatter, "{checkpoint}"),
            Some(checkpoint) => write!(formatter, ", {checkpoint}"),
        }
    }
}

/// Recovers a component by its own library.
///
/// # Errors
/// Why it did not succeed; the component is in ERROR then.
pub fn reset(
    component: &mut Component,
    standbys: &Standbys,
    checkpoint_before_ns: Option<u64>,
    loss: &Loss,
) -> Result<Recovered, String> {
    // Only an operator's order finds it destroyed.
    if !component.is_alive() || component.state() == LifeCycleState::Destroyed {
        return replace(
            component,
            standbys,
            component.variant(),
            checkpoint_before_ns,
            loss,
        );
    }
    if component.state() == LifeCycleState::Active {
        component
            .operate(Operation::StopOnError, loss)
            .map_err(|error| words("onError", &error))?;
    }
    component.begin_incarnation(component.incarnation() + 1);
    for (callback, name) in [
        (Callback::Reset, "onReset"),
        (Callback::Initialize, "onInitialize"),
    ] {
        component
            .call_back(callback, name, loss)
            .map_err(|error| words(name, &error))?;
    }
    let checkpoint = restore(component, checkpoint_before_ns, loss)?;
    start(component, loss)?;
    Ok(Recovered { by: "", checkpoint })
}

/// Puts a fresh instance of one of the component's libraries in its place.
///
/// # Errors
/// Why it did not succeed; the component is as it was before.
pub fn replace(
    component: &mut Component,
    standbys: &Standbys,
    variant: usize,
    checkpoint_before_ns: Option<u64>,
    loss: &Loss,
) -> Result<Recovered, String> {
    let (mut fresh, by) = standbys.take(variant)?;
    if component.is_alive() {
        give_up(component, loss);
    }
    if let Some(detectors) = component.services_mut().detectors() {
        // By them injected faults find the one that is brought up in its place.
        fresh.services_mut().set_detectors(detectors);
    }
    let prepared = standbys.bring_up(&mut fresh, loss);
    prepared.map_err(|reason| format!("{by}: {reason}"))?;
    fresh.succeed(component);
    fresh.set_variant(variant);
    std::mem::swap(component, &mut *fresh);
    standbys.retire(fresh);
    let checkpoint = restore(component, checkpoint_before_ns, loss)?;
    start(component, loss)?;
    Ok(Recovered { by, checkpoint })
}

/// The old instance lets go of its devices. That it fails at that is on record and changes nothing.
fn give_up(component: &mut Component, loss: &Loss) {
    if component.is_active() {
        let _recorded = component.operate(Operation::StopOnError, loss);
    }
    let _recorded = component.operate(Operation::Destroy, loss);
}

fn start(component: &mut Component, loss: &Loss) -> Result<(), String> {
    component.enter_ready();
    component
        .operate(Operation::Start, loss)
        .map_err(|error| words("onStart", &error))
}

/// Copies the newest certified checkpoint back and calls `onRecover`.
fn restore(
    component: &mut Component,
    checkpoint_before_ns: Option<u64>,
    loss: &Loss,
) -> Result<Option<Restored>, String> {
    let Some(before_ns) = checkpoint_before_ns else {
        return Ok(None);
    };
    let restored = component.restore_checkpoint(before_ns);
    if matches!(restored, Restored::Done { .. }) {
        component
            .call_back(Callback::Recover, "onRecover", loss)
            .map_err(|error| words("onRecover", &error))?;
    }
    Ok(Some(restored))
}

/// Why an operation failed, in words.
pub(super) fn words(what: &str, error: &OperationError) -> String {
    match error {
        OperationError::Refused => format!("{what} is not allowed in its state"),
        OperationError::Failed(fault) => {
            format!("{} in {}: {}", fault.kind, fault.callback, fault.message)
        }
    }
}
