//! The simulated world as the container hosts it: moved by the schedule, opened by components.

use std::fmt;
use std::io;
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use robot_simulation::{RobotSummary, Simulation, Transport, draw_drive};

use crate::component::Environment;
use crate::event_log::Event;

/// A simulated world. The lock is held for one step of the world or for opening a device, never
/// while a component runs.
pub struct World {
    simulation: Mutex<Simulation>,
    transport: Transport,
    reached: AtomicBool,
}

impl World {
    /// Hosts a world whose serial lines are pseudo-terminals (`real_time`) or pipes in the process:
    /// bytes pass a pseudo-terminal through a queue of the kernel, at no time one could rely on.
    pub fn new(simulation: Simulation, real_time: bool) -> Self {
        Self {
            simulation: Mutex::new(simulation),
            transport: if real_time {
                Transport::PseudoTerminal
            } else {
                Transport::InProcess
            },
            reached: AtomicBool::new(false),
        }
    }

    /// Moves the world to `now`; true once the robot has reached its target.
    pub fn advance_to(&self, now: Duration, environment: &Environment) -> bool {
        let mut simulation = self.lock();
        simulation.advance_to(now);
        let summary = simulation.summary();
        let time_ns = u64::try_from(simulation.time().as_nanos()).unwrap_or(u64::MAX);
        drop(simulation);
        if summary.reached && !self.reached.swap(true, Ordering::AcqRel) {
            environment.clock.advance_to(time_ns);
            environment.events.record(
                time_ns,
                Event::TargetReached {
                    time_s: summary.time_s.unwrap_or_default(),
                },
            );
        }
        self.has_reached_target()
    }

    /// Whether the robot has reached its target.
    pub fn has_reached_target(&self) -> bool {
        self.reached.load(Ordering::Acquire)
    }

    /// Time between two steps of the world.
    pub fn step_period(&self) -> Duration {
        self.lock().step_period()
    }

    /// How the drive went so far.
    pub fn summary(&self) -> RobotSummary {
        self.lock().summary()
    }

    /// A picture of the drive so far, as SVG.
    pub fn picture(&self) -> String {
        draw_drive(&self.lock())
    }

    /// Opens a device of the world; with its file, if it has one that a person can look at.
    ///
    /// # Errors
    /// If there is no such device, or it is unplugged.
    pub fn open(&self, device: &str) -> io::Result<(OwnedFd, Option<PathBuf>)> {
        let mut simulation = self.lock();
        let line = simulation.open(device, self.transport)?;
        Ok((line, simulation.slave_path(device).map(PathBuf::from)))
    }

    /// The simulation itself, for tests and fault injection.
    pub fn lock(&self) -> MutexGuard<'_, Simulation> {
        self.simulation
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for World {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("World")
            .field("reached", &self.has_reached_target())
            .finish_non_exhaustive()
    }
}
