//! Faults that are made on purpose, so that rules can be seen at work: when, where, what, and for
//! how long. Every name is resolved.

mod kinds;

pub use kinds::{CallbackName, ContainerFailure, Distortion, Misbehaviour, RobotSide, WorldFault};

use std::time::Duration;

use crate::specification::Place;

/// A file may hold so many injections: more than a campaign of one every minute for a day needs;
/// each is looked at in every cycle.
pub const MAX_INJECTIONS: usize = 2_000;

/// `exit` without a code.
pub const DEFAULT_EXIT_CODE: i32 = 1;

/// One fault that is made on purpose.
///
/// It *begins* at its trigger, and again as its repetition says. What then happens depends on the
/// fault: a lasting one ([`InjectedFault::lasts`]) stays for [`Self::lasting`], without that for
/// ever; any other one happens at the next opportunity, once, and with [`Self::lasting`] at every
/// opportunity of that time. An opportunity is a call of the callback, a datum of the port, or for
/// a fault of the container a load, a restoration or a recovery.
#[derive(Debug, Clone, PartialEq)]
pub struct Injection {
    /// When it begins first.
    pub trigger: Trigger,
    /// How long it stays.
    pub lasting: Option<Duration>,
    /// When it begins again; `None`: it begins once.
    pub repetition: Option<Repetition>,
    /// The chance, from 0 to 1, of each opportunity, drawn from the run's seed. With a probability
    /// an injection without [`Self::lasting`] is open for ever. Of faults of the world it is `None`.
    pub probability: Option<f64>,
    /// What happens.
    pub what: InjectedFault,
    /// Where it is written.
    pub place: Place,
}

/// When an injection begins first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trigger {
    /// At this time of the application's clock; for an injection into a running system, so long
    /// after it was asked for.
    At(Duration),
    /// With a component's n-th `onExecute`, counted from 1 over all its incarnations.
    AtCycle {
        /// Index of the component.
        component: usize,
        /// n.
        cycle: u64,
    },
}

/// When an injection begins again. Each interval counts from the beginning before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Repetition {
    /// How often it begins in all; `None`: without end.
    pub times: Option<u32>,
    /// How far apart.
    pub every: Interval,
}

/// How far apart the beginnings of an injection are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interval {
    /// In time, after [`Trigger::At`].
    Time(Duration),
    /// In cycles of the component of [`Trigger::AtCycle`].
    Cycles(u64),
}

/// What is made to go wrong.
#[derive(Debug, Clone, PartialEq)]
pub enum InjectedFault {
    /// In a callback, without the component's knowledge.
    Callback {
        /// Index of the component.
        component: usize,
        /// In which callback.
        callback: CallbackName,
        /// What it does instead of, or before, the component's own work.
        misbehaviour: Misbehaviour,
    },
    /// In the data of a port.
    Port {
        /// Index of the component.
        component: usize,
        /// Name of the data port.
        port: String,
        /// Path of the field; `None`: every number of the datum but its time. Whether the type has
        /// it is known only to the library.
        field: Option<String>,
        /// What happens to the data.
        distortion: Distortion,
    },
    /// In the simulated world.
    World {
        /// Index of a component in whose application's world it is; `None`: in the first world.
        component: Option<usize>,
        /// What goes wrong there.
        fault: WorldFault,
    },
    /// In the container's own handling.
    Container {
        /// Index of the component.
        component: usize,
        /// What fails.
        failure: ContainerFailure,
    },
}

impl InjectedFault {
    /// Whether it stays until it is taken away, rather than happening at an opportunity.
    pub fn lasts(&self) -> bool {
        match self {
            Self::Callback { misbehaviour, .. } => {
                matches!(misbehaviour, Misbehaviour::Slow(_) | Misbehaviour::Leak(_))
            }
            Self::Port { .. } | Self::World { .. } => true,
            Self::Container { .. } => false,
        }
    }

    /// The component that it is about; a fault of the world is about none.
    pub fn component(&self) -> Option<usize> {
        match self {
            Self::Callback { component, .. }
            | Self::Port { component, .. }
            | Self::Container { component, .. } => Some(*component),
            Self::World { .. } => None,
        }
    }

    /// Its KIND in injection files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Callback { misbehaviour, .. } => misbehaviour.name(),
            Self::Port { distortion, .. } => distortion.name(),
            Self::World { fault, .. } => fault.name(),
            Self::Container { failure, .. } => failure.name(),
        }
    }
}
