//! The simulated world as the container hosts it: moved by the schedule, opened by components. The
//! world of a supervised container is another process, which outlives it. A run may have several.

mod process;
mod protocol;
mod remote;
mod worlds;

use std::fmt;
use std::io;
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use robot_simulation::{Fault, RobotSummary, Simulation, Transport, draw_drive};

use crate::clock::nanoseconds;

pub use process::{STANDS, serve};
pub use remote::RemoteWorld;
pub use worlds::{Drives, Worlds, world_files, world_seed};

/// A simulated world.
pub struct World {
    place: Place,
    reached: AtomicBool,
}

enum Place {
    /// The lock is held for one step of the world or for opening a device, never while a component
    /// runs.
    Here {
        simulation: Box<Mutex<Simulation>>,
        transport: Transport,
    },
    Elsewhere(RemoteWorld),
}

impl World {
    /// Hosts a world whose serial lines are pseudo-terminals (`real_time`) or pipes in the process:
    /// bytes pass a pseudo-terminal through a queue of the kernel, at no time one could rely on.
    pub fn new(simulation: Simulation, real_time: bool) -> Self {
        let transport = if real_time {
            Transport::PseudoTerminal
        } else {
            Transport::InProcess
        };
        Self::at(Place::Here {
            simulation: Box::new(Mutex::new(simulation)),
            transport,
        })
    }

    /// A world in another process, which moves by itself.
    pub fn remote(world: RemoteWorld) -> Self {
        Self::at(Place::Elsewhere(world))
    }

    fn at(place: Place) -> Self {
        Self {
            place,
            reached: AtomicBool::new(false),
        }
    }

    /// Moves the world to `now`, if it is not elsewhere. When the robot has just reached its target:
    /// the world's time in nanoseconds, and the drive's in seconds.
    pub fn advance_to(&self, now: Duration) -> Option<(u64, f64)> {
        let (summary, time) = match &self.place {
            Place::Here { simulation, .. } => {
                let mut simulation = lock(simulation);
                simulation.advance_to(now);
                (simulation.summary(), simulation.time())
            }
            Place::Elsewhere(world) => (world.summary(), now),
        };
        let just_reached = summary.reached && !self.reached.swap(true, Ordering::AcqRel);
        just_reached.then(|| (nanoseconds(time), summary.time_s.unwrap_or_default()))
    }

    /// Whether the robot has reached its target.
    pub fn has_reached_target(&self) -> bool {
        self.reached.load(Ordering::Acquire)
    }

    /// Time between two steps of the world, or two looks at it.
    pub fn step_period(&self) -> Duration {
        match &self.place {
            Place::Here { simulation, .. } => lock(simulation).step_period(),
            Place::Elsewhere(_) => remote::LOOK_PERIOD,
        }
    }

    /// How the drive went so far.
    pub fn summary(&self) -> RobotSummary {
        match &self.place {
            Place::Here { simulation, .. } => lock(simulation).summary(),
            Place::Elsewhere(world) => world.summary(),
        }
    }

    /// A picture of the drive so far, as SVG.
    ///
    /// # Errors
    /// If the world is in another process and does not answer.
    pub fn picture(&self) -> io::Result<String> {
        match &self.place {
            Place::Here { simulation, .. } => Ok(draw_drive(&lock(simulation))),
            Place::Elsewhere(world) => world.picture(),
        }
    }

    /// Opens a device of the world; with its file, if it has one that a person can look at.
    ///
    /// # Errors
    /// If there is no such device, or it is unplugged.
    pub fn open(&self, device: &str) -> io::Result<(OwnedFd, Option<PathBuf>)> {
        match &self.place {
            Place::Here {
                simulation,
                transport,
            } => {
                let mut simulation = lock(simulation);
                let line = simulation.open(device, *transport)?;
                Ok((line, simulation.slave_path(device).map(PathBuf::from)))
            }
            Place::Elsewhere(world) => world.open(device),
        }
    }

    /// Makes a fault of the robot's hardware appear, or repairs it.
    pub fn set_fault(&self, fault: Fault, present: bool) {
        match &self.place {
            Place::Here { simulation, .. } if present => lock(simulation).set_fault(fault),
            Place::Here { simulation, .. } => lock(simulation).clear_fault(fault),
            Place::Elsewhere(world) => world.set_fault(fault, present),
        }
    }
}

fn lock(simulation: &Mutex<Simulation>) -> MutexGuard<'_, Simulation> {
    simulation.lock().unwrap_or_else(PoisonError::into_inner)
}

impl fmt::Debug for World {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("World")
            .field("reached", &self.has_reached_target())
            .finish_non_exhaustive()
    }
}
