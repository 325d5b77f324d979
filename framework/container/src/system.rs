//! A running application: brought up in order, run, and stopped in order, each with a deadline.

mod agenda;
mod real_time;
mod stages;
mod supervise;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crossbeam::channel::Sender;
use robot_simulation::Simulation;
use system_model::injection::Injection;
use system_model::process_model::ProcessModel;
use system_model::rules::FaultRules;
use system_model::specification::ApplicationSpecification;

use crate::assembly::{Assembly, AssemblyProblem, LibraryOptions, assemble};
use crate::clock::Clock;
use crate::component::{ComponentCell, Environment};
use crate::control::RunningSystem;
use crate::device::Devices;
use crate::event_log::{Event, EventLog, EventWriter};
use crate::injection::Injections;
use crate::lane::{Crew, Lane, remaining};
use crate::library::PortDescription;
use crate::schedule::BusyTime;
use crate::status::ComponentStatus;
use crate::summary::{ApplicationSummary, ComponentSummary, Summary, application_state};
use crate::supervision::{ManagerThreads, Observations, Scenes, Supervisor};
use crate::world::World;

pub use agenda::Failure;
use agenda::LeftBehind;
use real_time::WorldThread;
use supervise::{inject, supervise};

/// Loading devices, models and maps takes time; what the watchdog cannot break off by then hangs.
/// Half as long again as one callback of bringing up may take, so that the watchdog is first.
const BRING_UP_LIMIT: Duration = Duration::from_secs(45);

/// In which everything must have stopped: what a person waits after Ctrl-C before pulling the plug.
const STOP_LIMIT: Duration = Duration::from_secs(3);

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
    /// What counts as a fault and what is done about it; none: the defaults.
    pub rules: FaultRules,
    /// The process models that the rules name, by the name that they use.
    pub models: Vec<(String, ProcessModel)>,
    /// Faults that are made on purpose.
    pub injections: Vec<Injection>,
}

/// Why an application did not start. Nothing of it runs.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// It cannot be assembled.
    #[error("{}", list(.0))]
    Assembly(Vec<AssemblyProblem>),
    /// Components refused to be initialised or started.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Components(Vec<Failure>),
    /// Bringing it up took too long.
    #[error(
        "component '{component}' did not return within {} s from onInitialize or onStart\n  help: see its properties and the devices it opens; nothing was started",
        BRING_UP_LIMIT.as_secs()
    )]
    Hangs {
        /// Instance name.
        component: String,
    },
    /// A rule asks for checkpoints of components that register no memory.
    #[error(
        "{} registered no memory (`critical`) by the end of onStart, so there is nothing to back up\n  help: take <backup> out of the rules of {}, or let the component register its state",
        list_names(.components), list_names(.components)
    )]
    NothingToBackUp {
        /// Instance names.
        components: Vec<String>,
    },
    /// The event file cannot be written.
    #[error("{} cannot be written: {error}", .path.display())]
    Output {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The system refused threads or files.
    #[error("the container cannot run: {0}")]
    System(#[from] std::io::Error),
}

fn list_names(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    quoted.join(", ")
}

fn list(problems: &[AssemblyProblem]) -> String {
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

fn environment(clock: ClockKind, events: EventLog, world: Option<Arc<World>>) -> Environment {
    Environment {
        clock: match clock {
            ClockKind::Real => Clock::real(),
            ClockKind::Simulated => Clock::simulated(),
        },
        events,
        devices: Devices::new(world.clone()),
        observations: Observations::default(),
        scenes: Scenes::default(),
        injections: Injections::default(),
        world,
        busy: BusyTime::default(),
    }
}

/// A running application.
pub struct System {
    specification: ApplicationSpecification,
    options: RunOptions,
    environment: Arc<Environment>,
    world: Option<Arc<World>>,
    world_thread: Option<WorldThread>,
    components: Arc<[Arc<ComponentCell>]>,
    interfaces: Arc<[Vec<PortDescription>]>,
    statuses: Vec<Arc<ComponentStatus>>,
    crew: Arc<Crew>,
    /// Each with the numbers of the components that it runs.
    lanes: Vec<(Arc<Lane>, Vec<usize>)>,
    left_behind: LeftBehind,
    supervisor: Arc<Supervisor>,
    manager_threads: ManagerThreads,
    writer: EventWriter,
}

impl System {
    /// Assembles an application and brings it up; when this returns it runs.
    ///
    /// # Errors
    /// If anything is wrong; then nothing of it runs.
    pub fn start(
        specification: &ApplicationSpecification,
        simulation: Option<Simulation>,
        mut options: RunOptions,
    ) -> Result<Self, StartError> {
        let real = options.clock == ClockKind::Real;
        let world = simulation.map(|simulation| Arc::new(World::new(simulation, real)));
        let (events, writer) =
            EventLog::open(options.events.as_deref(), !real, options.echo.take()).map_err(
                |error| StartError::Output {
                    path: options.events.clone().unwrap_or_default(),
                    error,
                },
            )?;
        let environment = Arc::new(environment(options.clock, events, world.clone()));
        let assembly = assemble(
            specification,
            &options.rules,
            &options.libraries,
            &environment,
        )
        .map_err(StartError::Assembly)?;
        let names = specification.components.iter().map(|it| it.name.clone());
        environment.injections.prepare(names, options.seed);
        inject(&options.injections, &assembly, &environment).map_err(StartError::Assembly)?;
        let (supervisor, wanted) = supervise(
            specification,
            &options.rules,
            &options.models,
            &assembly,
            &environment,
        )
        .map_err(StartError::Assembly)?;
        let Assembly {
            components,
            statuses,
            executors,
            interfaces,
            ..
        } = assembly;
        let mut system = Self {
            specification: specification.clone(),
            options,
            environment,
            world,
            world_thread: None,
            left_behind: components.iter().map(|_| AtomicBool::new(false)).collect(),
            components: components.into(),
            interfaces: interfaces.into(),
            statuses,
            crew: Crew::new()?,
            lanes: Vec::new(),
            supervisor: Arc::new(supervisor),
            manager_threads: ManagerThreads::default(),
            writer,
        };
        if let Err(error) = system.bring_up() {
            // The refusal counts; a log that cannot be written either does not change it.
            let _log_error = system.close();
            return Err(error);
        }
        if let Err(error) = system.launch(executors, wanted) {
            let _nothing_to_sum_up = system.stop("start_refused");
            return Err(error);
        }
        Ok(system)
    }

    /// What the container knows of each component.
    pub fn statuses(&self) -> &[Arc<ComponentStatus>] {
        &self.statuses
    }

    /// Time by the application's clock.
    pub fn now(&self) -> Duration {
        self.environment.clock.now()
    }

    /// The fault manager's shell.
    pub fn supervisor(&self) -> &Arc<Supervisor> {
        &self.supervisor
    }

    /// What an operator may ask of it while it runs.
    pub fn control(&self) -> RunningSystem {
        RunningSystem {
            specification: self.specification.clone(),
            interfaces: Arc::clone(&self.interfaces),
            statuses: self.statuses.clone(),
            supervisor: Arc::clone(&self.supervisor),
        }
    }

    /// The world, if there is one.
    pub fn world(&self) -> Option<&Arc<World>> {
        self.world.as_ref()
    }

    /// Why the run is over, if it is: waits at most `limit` for that.
    pub fn wait(&self, limit: Duration) -> Option<&'static str> {
        match self.options.clock {
            ClockKind::Simulated => {
                let ended = self.lanes.iter().all(|(lane, _)| lane.wait(limit));
                ended.then(|| self.reason())
            }
            ClockKind::Real => {
                let left = self
                    .options
                    .duration
                    .map_or(limit, |duration| duration.saturating_sub(self.now()));
                if !self.is_over() {
                    std::thread::sleep(left.min(limit));
                }
                self.is_over().then(|| self.reason())
            }
        }
    }

    /// Stops everything in order and says what the run came to.
    pub fn stop(mut self, reason: &'static str) -> (Summary, Option<std::io::Error>) {
        let summary = self.summary(reason);
        let deadline = Instant::now() + STOP_LIMIT;
        self.manager_threads.stop(&self.supervisor);
        for (lane, _) in &self.lanes {
            lane.stop();
        }
        for (lane, members) in &self.lanes {
            if !lane.wait(remaining(deadline)) {
                self.leave_behind(lane, members);
            }
        }
        if let Some(world_thread) = self.world_thread.take() {
            world_thread.stop();
        }
        self.shut_down(remaining(deadline).max(STOP_LIMIT / 3));
        let events_lost = self.environment.events.lost();
        self.environment.events.record(
            self.environment.clock.now_ns(),
            Event::RunStopped {
                reason,
                events_lost,
            },
        );
        (summary, self.close().err())
    }

    /// A component of this lane hangs: a thread is inside it, and nobody may enter it or those
    /// that share its lane.
    fn leave_behind(&self, lane: &Lane, members: &[usize]) {
        for member in members {
            self.left_behind[*member].store(true, Ordering::Release);
        }
        self.notice(&format!(
            "executor '{}' did not return: its components are left behind, not stopped",
            lane.name()
        ));
    }

    fn close(self) -> std::io::Result<()> {
        self.crew.dismiss();
        self.environment.events.finish();
        self.writer.close()
    }

    fn notice(&self, message: &str) {
        self.environment.events.record(
            self.environment.clock.now_ns(),
            Event::Notice {
                message: message.to_owned(),
            },
        );
    }

    fn is_over(&self) -> bool {
        let reached = self
            .world
            .as_ref()
            .is_some_and(|world| world.has_reached_target());
        let elapsed = self
            .options
            .duration
            .is_some_and(|duration| self.now() >= duration);
        reached || elapsed
    }

    fn reason(&self) -> &'static str {
        let reached = self
            .world
            .as_ref()
            .is_some_and(|world| world.has_reached_target());
        if reached {
            "target_reached"
        } else {
            "duration_elapsed"
        }
    }

    fn summary(&self, ended_by: &'static str) -> Summary {
        let application = ApplicationSummary {
            state: application_state(self.statuses.iter().map(|status| status.state())),
            ended_by,
            time_s: self.now().as_secs_f64(),
            clock: self.options.clock.name(),
            seed: self.options.seed,
            events_lost: self.environment.events.lost(),
        };
        Summary {
            applications: [(self.specification.name.clone(), application)].into(),
            components: self
                .statuses
                .iter()
                .map(|status| (status.name.clone(), ComponentSummary::of(status)))
                .collect(),
            robot: self.world.as_ref().map(|world| world.summary()),
        }
    }
}
