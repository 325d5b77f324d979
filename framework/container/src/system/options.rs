//! How applications are run.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::Sender;
use robot_simulation::Simulation;
use system_model::injection::Injection;
use system_model::network::NetworkSpecification;

use super::StartError;
use crate::adaptation::AdaptationRequests;
use crate::assembly::LibraryOptions;
use crate::clock::Clock;
use crate::component::Environment;
use crate::event_log::{Event, EventLog, EventWriter};
use crate::injection::{Injections, still_to_come};
use crate::outer_supervision::Supervised;
use crate::recording::{Recorder, RecordingOptions};
use crate::replay::Score;
use crate::schedule::BusyTime;
use crate::supervision::{Observations, Scenes};
use crate::world::{Drives, World, Worlds};

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
    /// The recording that is played instead of components, in simulated time.
    pub score: Option<Arc<Score>>,
    /// What is recorded.
    pub recording: RecordingOptions,
    /// The parent that supervises this container, if one does.
    pub supervised: Option<Arc<Supervised>>,
    /// The place in the network of one of the applications, which is given by its number.
    pub network: Option<(usize, NetworkSpecification)>,
}

/// Where checkpoints lie that outlive the container, and what becomes of those that are there.
#[derive(Debug, Clone, Default)]
pub struct StateOptions {
    /// The folder; `None`: that of the environment.
    pub folder: Option<PathBuf>,
    /// Those that are there are removed, not restored.
    pub fresh: bool,
}

impl RunOptions {
    /// What of a run's injections this container makes: one that goes on where another has died does
    /// not begin anew.
    pub(super) fn injections(&self, all: &[Injection]) -> Vec<Injection> {
        let before = self.supervised.as_ref().filter(|it| it.restarts() > 0);
        let run_time = before.map_or(Duration::ZERO, |it| it.run_time());
        let to_come = |injection| still_to_come(injection, run_time);
        all.iter().filter_map(to_come).collect()
    }

    /// The worlds of a run: in the process that outlives this one, if that has one, else here.
    pub(super) fn worlds(
        &self,
        applications: &[Drives<'_>],
        simulations: Vec<Simulation>,
    ) -> Worlds {
        let real = self.clock == ClockKind::Real;
        let outside = self.supervised.as_ref().and_then(|it| it.world());
        let inside = simulations.into_iter();
        let inside = inside.map(|it| Arc::new(World::new(it, real)));
        Worlds::new(applications, outside.cloned().into_iter().chain(inside))
    }

    /// What the components share.
    pub(super) fn environment(&self, events: EventLog, worlds: Worlds) -> Arc<Environment> {
        // How long the run has lasted when this container comes into it.
        let run_time = self.supervised.as_ref().map(|it| it.run_time());
        Arc::new(Environment {
            clock: match self.clock {
                ClockKind::Real => Clock::real_since(run_time.unwrap_or_default()),
                ClockKind::Simulated => Clock::simulated(),
            },
            events,
            observations: Observations::default(),
            injections: Injections::default(),
            scenes: Scenes::default(),
            worlds,
            score: self.score.clone(),
            adaptation_requests: AdaptationRequests::default(),
            busy: BusyTime::default(),
        })
    }

    /// The recording that is asked for, and where events go for it.
    pub(super) fn recorder(&self) -> (Option<Recorder>, Option<Sender<(u64, Event)>>) {
        if !self.recording.any() {
            return (None, None);
        }
        let mut options = self.recording.clone();
        let restarts = self.supervised.as_ref().map_or(0, |it| it.restarts());
        options.file = options.file.map(|file| after_restarts(file, restarts));
        let (recorder, events) = Recorder::new(options, self.clock == ClockKind::Simulated);
        (Some(recorder), Some(events))
    }

    /// Opens the event file: a fresh one, or that of the container before.
    pub(super) fn open_events(
        &mut self,
        recorded: Option<Sender<(u64, Event)>>,
    ) -> Result<(EventLog, EventWriter), StartError> {
        let (path, echo) = (self.events.as_deref(), self.echo.take());
        let waits = self.clock == ClockKind::Simulated;
        let opened = match self.supervised {
            Some(_) => EventLog::resume(path, waits, echo),
            None => EventLog::open(path, waits, echo),
        };
        let opened = opened.map_err(|error| StartError::Output {
            path: self.events.clone().unwrap_or_default(),
            error,
        });
        opened.map(|(events, writer)| (events.recorded_by(recorded), writer))
    }
}

/// A container that goes on where another has died leaves that one's recording as it is, and writes
/// `drive-restart-1.mcap` beside `drive.mcap`.
fn after_restarts(file: PathBuf, restarts: u32) -> PathBuf {
    if restarts == 0 {
        return file;
    }
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}-restart-{restarts}.mcap"))
}
