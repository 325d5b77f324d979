//! How applications are run.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::Sender;

use crate::assembly::LibraryOptions;
use crate::clock::Clock;
use crate::component::Environment;
use crate::device::Devices;
use crate::event_log::{Event, EventLog};
use crate::injection::Injections;
use crate::schedule::BusyTime;
use crate::supervision::{Observations, Scenes};
use crate::world::World;

/// Which clock an application runs by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClockKind {
    /// The machine's.
    Real,
    /// As fast as it goes, one thread, the same every time.
    Simulated,
}

impl ClockKind {
    /// The word used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Real => "real",
            Self::Simulated => "simulated",
        }
    }

    /// What components share that run by this clock.
    pub(super) fn environment(self, events: EventLog, world: Option<Arc<World>>) -> Environment {
        Environment {
            clock: match self {
                ClockKind::Real => Clock::real(),
                ClockKind::Simulated => Clock::simulated(),
            },
            events,
            devices: Devices::new(world.clone()),
            observations: Observations::default(),
            injections: Injections::default(),
            scenes: Scenes::default(),
            world,
            busy: BusyTime::default(),
        }
    }
}

/// How an application is run.
#[derive(Debug)]
pub struct RunOptions {
    /// The clock.
    pub clock: ClockKind,
    /// For how long, by that clock; `None`: until stopped or the target is reached.
    pub duration: Option<Duration>,
    /// Seed of the simulated world, for the record.
    pub seed: u64,
    /// Where events are written.
    pub events: Option<PathBuf>,
    /// Where events are echoed for a person.
    pub echo: Option<Sender<(u64, Event)>>,
    /// How libraries are found and loaded.
    pub libraries: LibraryOptions,
    /// Where checkpoints lie that outlive the container.
    pub state: StateOptions,
}

/// Where checkpoints lie that outlive the container, and what becomes of those that are there.
#[derive(Debug, Clone, Default)]
pub struct StateOptions {
    /// The folder; `None`: that of the environment.
    pub folder: Option<PathBuf>,
    /// Those that are there are removed, not restored.
    pub fresh: bool,
}
