//! The emergency stop: every actuator at once, latched, and no jump when it is over.
//!
//! The command ports of actuators read their safe value from the moment of the decision, whatever
//! their executors are doing; on resuming they go on reading it until a command has come that was
//! written after that moment.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use fault_manager::ActionId;
use system_model::rules::StopCategory;

/// For how long an actuator of category 1 may stop its motion under control before its power is
/// taken away: from walking speed a robot stands within this, as a person does.
pub const CONTROLLED_STOP: Duration = Duration::from_secs(1);

/// Whether a command port reads its safe value.
#[derive(Debug, Default)]
pub struct SafetyGate {
    /// Data written before this are not commands any more; [`CLOSED`] while the stop is latched.
    open_since_ns: AtomicU64,
}

/// No time is later.
const CLOSED: u64 = u64::MAX;

impl SafetyGate {
    /// Whether a datum written at this time may pass.
    #[inline]
    pub fn passes(&self, stamp_ns: u64) -> bool {
        stamp_ns >= self.open_since_ns.load(Ordering::Acquire)
    }

    fn close(&self) {
        self.open_since_ns.store(CLOSED, Ordering::Release);
    }

    fn open(&self, now_ns: u64) {
        self.open_since_ns.store(now_ns, Ordering::Release);
    }
}

/// One actuator.
#[derive(Debug)]
pub struct Actuator {
    /// Its number in the application.
    pub component: usize,
    /// How it stops.
    pub category: StopCategory,
    /// In front of its command ports.
    pub gate: Arc<SafetyGate>,
}

/// How one actuator is to be stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ActuatorStop {
    /// Its number in the application.
    pub component: usize,
    /// After how long its power is taken away, if at all.
    pub power_off_after: Option<Duration>,
}

/// All actuators.
#[derive(Debug, Default)]
pub struct Emergency {
    actuators: Vec<Actuator>,
    /// Actuators that have not answered the stop that is under way.
    waiting: AtomicUsize,
    action: AtomicU64,
}

impl Emergency {
    /// These are the actuators.
    pub fn new(actuators: Vec<Actuator>) -> Self {
        Self {
            actuators,
            ..Self::default()
        }
    }

    /// The gate of an actuator.
    pub fn gate(&self, component: usize) -> Option<Arc<SafetyGate>> {
        let actuator = self.actuators.iter().find(|one| one.component == component);
        actuator.map(|one| Arc::clone(&one.gate))
    }

    /// Closes all gates; what is to be done with each actuator.
    pub(super) fn engage(&self, action: ActionId) -> Vec<ActuatorStop> {
        self.action.store(action.0, Ordering::Release);
        self.waiting.store(self.actuators.len(), Ordering::Release);
        for gate in self.actuators.iter().map(|one| &one.gate) {
            gate.close();
        }
        let stop = |actuator: &Actuator| ActuatorStop {
            component: actuator.component,
            power_off_after: match actuator.category {
                StopCategory::PowerOff => Some(Duration::ZERO),
                StopCategory::ControlledThenOff => Some(CONTROLLED_STOP),
                StopCategory::Controlled => None,
            },
        };
        self.actuators.iter().map(stop).collect()
    }

    /// Whether an action is the emergency stop.
    pub(super) fn is_for(&self, action: ActionId) -> bool {
        self.action.load(Ordering::Acquire) == action.0
    }

    /// An actuator has been told; whether it was the last one of this action.
    pub(super) fn answered(&self, action: ActionId) -> bool {
        self.action.load(Ordering::Acquire) == action.0
            && self.waiting.fetch_sub(1, Ordering::AcqRel) == 1
    }

    /// Opens all gates for commands that are written from now on; the actuators.
    pub(super) fn rearm(&self, now_ns: u64) -> Vec<usize> {
        for gate in self.actuators.iter().map(|one| &one.gate) {
            gate.open(now_ns.max(1));
        }
        self.actuators.iter().map(|one| one.component).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_command_from_before_the_resume_passes() {
        let gate = Arc::new(SafetyGate::default());
        let actuator = |component, category| Actuator {
            component,
            category,
            gate: Arc::clone(&gate),
        };
        let emergency = Emergency::new(vec![
            actuator(3, StopCategory::PowerOff),
            actuator(5, StopCategory::ControlledThenOff),
            actuator(7, StopCategory::Controlled),
        ]);
        assert!(gate.passes(0));
        let stops = emergency.engage(ActionId(9));
        let expected = [
            (3, Some(Duration::ZERO)),
            (5, Some(CONTROLLED_STOP)),
            (7, None),
        ];
        let stops: Vec<_> = stops
            .iter()
            .map(|it| (it.component, it.power_off_after))
            .collect();
        assert_eq!(stops, expected);
        assert!(!gate.passes(0) && !gate.passes(1_000));
        let last: Vec<bool> = (0..3).map(|_| emergency.answered(ActionId(9))).collect();
        assert_eq!(last, [false, false, true]);
        assert_eq!(emergency.rearm(500), [3, 5, 7]);
        assert!(!gate.passes(499) && gate.passes(500));
    }
}
