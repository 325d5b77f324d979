//! What the fault manager wants done.

use std::time::Duration;

use crate::verdict::{FaultId, Verdict};

/// Numbers actions from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ActionId(pub u64);

/// One thing for the container to do, in the order given.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Apply an action; its end is to be observed ([`crate::Observation::Ended`]).
    Act(PlannedAction),
    /// Nothing more is expected of an action that has not ended: it is overdue or overtaken. Its
    /// end, should it come, changes nothing.
    Abandon(ActionId),
    /// Put a verdict on record: it is new or has changed.
    Record(Box<Verdict>),
    /// The emergency stop has been cleared: actuators wait for a fresh command.
    Rearm,
}

/// An action with its conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedAction {
    /// Its number.
    pub id: ActionId,
    /// The fault that it is for.
    pub fault: FaultId,
    /// What to do.
    pub action: Action,
    /// Not before this time (`backoff`).
    pub not_before: Duration,
    /// By this time it must have ended and the component worked (`recovery/@deadline`).
    pub deadline: Option<Duration>,
}

/// What can be done.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Recovery in place: onReset, onInitialize, (memory restored, onRecover,) onStart; on a fresh
    /// instance of a fresh copy of the library if the old one cannot be called any more.
    Reset {
        /// Index of the component.
        component: usize,
        /// The newest certified checkpoint that was taken before this time is restored; `None`: no
        /// checkpoint is wanted.
        checkpoint_before: Option<Duration>,
    },
    /// The secondary takes the component's place.
    Replace {
        /// Index of the component.
        component: usize,
        /// Index in its rules' `secondaries`.
        secondary: usize,
        /// As for a reset.
        checkpoint_before: Option<Duration>,
    },
    /// The task that it takes part in is done without it, in another way.
    Adapt {
        /// Index of the component.
        component: usize,
    },
    /// ACTIVE -> INACTIVE.
    Stop {
        /// Index of the component.
        component: usize,
    },
    /// -> DESTROYED.
    Destroy {
        /// Index of the component.
        component: usize,
    },
    /// A behaviour tree is begun for a fault of the component; it ends as the tree does.
    Handle {
        /// Index of the component.
        component: usize,
        /// Index of the tree, behind those of all components.
        tree: usize,
        /// By then it must have ended.
        within: Duration,
    },
    /// All actuators, each by its stop category; latched until [`Effect::Rearm`].
    EmergencyStop,
}

impl Action {
    /// The component it is about; none for all actuators.
    pub fn component(&self) -> Option<usize> {
        match self {
            Self::Reset { component, .. }
            | Self::Replace { component, .. }
            | Self::Adapt { component }
            | Self::Stop { component }
            | Self::Destroy { component }
            | Self::Handle { component, .. } => Some(*component),
            Self::EmergencyStop => None,
        }
    }
}
