//! Plans and actions in words.

use std::time::Duration;

use crate::plan::Action;
use crate::system::System;
use crate::verdict::FaultId;

/// `reset path_planner`, `replace obstacle_avoidance by obstacle_avoidance_simple`, `stop camera`.
pub(crate) fn action(system: &System, action: &Action) -> String {
    let name = |component: usize| system.components[component].name.as_str();
    match action {
        Action::Reset { component, .. } => format!("reset {}", name(*component)),
        Action::Replace {
            component,
            secondary,
            ..
        } => {
            let secondaries = &system.components[*component].rules.secondaries;
            let other = &secondaries[*secondary].specification.type_name;
            format!("replace {} by {other}", name(*component))
        }
        Action::Adapt { component } => format!("do the task without {}", name(*component)),
        Action::Stop { component } => format!("stop {}", name(*component)),
        Action::Destroy { component } => format!("destroy {}", name(*component)),
        Action::Handle {
            component, tree, ..
        } => format!("handle {} by tree {}", name(*component), name(*tree)),
        Action::EmergencyStop => "emergency stop".to_owned(),
    }
}

/// One of several resets.
pub(crate) fn reset(component: &str, attempt: u32, of: u32, window: Duration) -> String {
    let window = window.as_secs_f64();
    format!("reset {component} ({attempt} of {of} within {window} s)")
}

/// An application that is stopped as a whole.
pub(crate) fn application(name: &str) -> String {
    format!("stop application {name}")
}

/// A component that is stopped or destroyed because it needs something.
pub(crate) fn dependent(action: &str, wanted: &str) -> String {
    format!("{action}: it needs {wanted}")
}

/// A fault that is judged anew as a root cause.
pub(crate) fn judged_anew(id: FaultId) -> String {
    format!("judged anew as fault {}", id.0)
}

/// An action that gave way to a stop for another fault.
pub(crate) fn overtaken(id: FaultId) -> String {
    format!("overtaken by a stop for fault {}", id.0)
}

/// A fault whose component was stopped for another fault before it was its turn.
pub(crate) fn stopped_for(id: FaultId) -> String {
    format!("nothing more: stopped for fault {}", id.0)
}

/// Nothing is done.
pub(crate) const RECORD_ONLY: &str = "record only";

/// No recovery begins while the robot stands still by an emergency stop.
pub(crate) const WAIT: &str = "wait until the emergency stop is cleared";

/// A second reason for an emergency stop.
pub(crate) const IN_FORCE: &str = "emergency stop, which is in force already";
