//! Running applications: brought up in order, run, and stopped in order, each with a deadline.

mod adaptation;
mod agenda;
mod applications;
mod knowledge;
mod missions;
mod options;
mod outcome;
mod persistence;
mod real_time;
mod recording;
mod stages;
mod start_error;
mod supervise;

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use robot_simulation::Simulation;
use system_model::specification::ApplicationSpecification;

use crate::assembly::{Link, assemble_together};
use crate::component::{ComponentCell, Environment};
use crate::event_log::{Event, EventWriter};
use crate::lane::{Crew, Lane, remaining};
use crate::library::PortDescription;
use crate::mission::{Calls, MissionThreads, Runner, TreeStatus};
use crate::network::{self, Network};
use crate::recording::RecordingThread;
use crate::status::{ComponentStatus, Meter};
use crate::summary::Summary;
use crate::supervision::{ManagerThreads, Supervisor};

pub use agenda::Failure;
use agenda::{LeftBehind, nobody};
pub use applications::Application;
use applications::Applications;
pub use options::{ClockKind, RunOptions, StateOptions};
use persistence::Persistence;
use real_time::WorldThread;
pub use start_error::StartError;
use supervise::{inject, supervise};

/// Loading devices, models and maps takes time; what the watchdog cannot break off by then hangs.
/// Half as long again as one callback of bringing up may take, so that the watchdog is first.
const BRING_UP_LIMIT: Duration = Duration::from_secs(45);

/// In which everything must have stopped: what a person waits after Ctrl-C before pulling the plug.
const STOP_LIMIT: Duration = Duration::from_secs(3);

/// Running applications.
pub struct System {
    /// Everything that runs, as one application.
    specification: ApplicationSpecification,
    /// The name of each application, and its components.
    applications: Vec<(String, Range<usize>)>,
    options: RunOptions,
    environment: Arc<Environment>,
    world_thread: Option<WorldThread>,
    components: Arc<[Arc<ComponentCell>]>,
    interfaces: Arc<[Vec<PortDescription>]>,
    statuses: Vec<Arc<ComponentStatus>>,
    meter: Arc<Meter>,
    links: Arc<[Link]>,
    began: Instant,
    crew: Arc<Crew>,
    /// Each with the numbers of the components that it runs.
    lanes: Vec<(Arc<Lane>, Vec<usize>)>,
    left_behind: LeftBehind,
    supervisor: Arc<Supervisor>,
    manager_threads: ManagerThreads,
    trees: Vec<Arc<TreeStatus>>,
    mission_threads: MissionThreads,
    /// What trees ask of services.
    calls: Arc<Calls>,
    persistence: Persistence,
    writer: EventWriter,
    recording: Option<RecordingThread>,
    /// Ends first: nothing comes in any more when components are stopped.
    network: Option<Network>,
}

impl System {
    /// Assembles applications and brings them up; when this returns they run. Their names differ,
    /// and `simulations` has the worlds of their [`world_files`](crate::world::world_files). Where there
    /// are several applications, their components are called `application/component`.
    ///
    /// # Errors
    /// If anything is wrong; then nothing of them runs.
    pub fn start(
        applications: Vec<Application>,
        simulations: Vec<Simulation>,
        mut options: RunOptions,
    ) -> Result<Self, StartError> {
        let began = Instant::now();
        let applications = Applications::new(applications);
        let worlds = options.worlds(&applications.drives(), simulations);
        let (mut recorder, recorded) = options.recorder();
        let (events, writer) = options.open_events(recorded)?;
        let (events, network) = network::hear(events, options.network.take());
        let environment = options.environment(events, worlds);
        let specification = &applications.specification;
        let assembly = assemble_together(
            specification,
            &applications.firsts(),
            &applications.rules,
            &options.libraries,
            &environment,
        )
        .map_err(StartError::Assembly)?;
        let names = specification.components.iter().map(|it| it.name.clone());
        let ports = network::connect(network, &applications.firsts(), specification, &assembly);
        environment.injections.prepare(names, options.seed);
        let injections = options.injections(&applications.injections);
        inject(&injections, &assembly, &environment).map_err(StartError::Assembly)?;
        let (supervisor, wanted) =
            supervise(&applications, &assembly, &environment).map_err(StartError::Assembly)?;
        let supervisor = Arc::new(supervisor);
        let (runners, calls) = missions::bind_all(&applications, &assembly, &supervisor)?;
        recording::play(&applications, &assembly, &environment)?;
        recorder
            .iter_mut()
            .for_each(|it| supervisor.record_models(it));
        let recording = recorder
            .map(|it| recording::record(it, &applications, &assembly, &environment, &options));
        let recording = recording.transpose()?;
        let meter = Arc::new(real_time::meter(&assembly.statuses, &assembly.executors));
        let network = network::enter(ports, &environment)?;
        let around = (&environment, &meter, network.as_ref());
        let adaptations = adaptation::adapt(&applications, &assembly, around)?;
        let persistence = Persistence::new(&applications, &assembly.factories);
        let system = Self {
            applications: applications.names(),
            specification: applications.specification,
            options,
            environment,
            world_thread: None,
            left_behind: nobody(assembly.components.len()),
            components: assembly.components.into(),
            interfaces: assembly.interfaces.into(),
            statuses: assembly.statuses,
            meter,
            links: assembly.links.into(),
            began,
            crew: Crew::new()?,
            lanes: Vec::new(),
            supervisor,
            manager_threads: ManagerThreads::default(),
            trees: runners.iter().map(Runner::status).collect(),
            mission_threads: MissionThreads::default(),
            calls,
            persistence,
            writer,
            recording,
            network,
        };
        system.begin(assembly.executors, adaptations, runners, wanted)
    }

    /// Why the run is over, if it is: waits at most `limit` for that. Rates and loads are counted
    /// between such waits.
    pub fn wait(&self, limit: Duration) -> Option<&'static str> {
        self.meter.look(self.now());
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

    /// The behaviour trees of all applications.
    pub fn trees(&self) -> &[Arc<TreeStatus>] {
        &self.trees
    }

    /// Stops everything in order and says what the run came to.
    pub fn stop(mut self, reason: &'static str) -> (Summary, Option<std::io::Error>) {
        let mut summary = self.summary(reason);
        drop(self.network.take());
        let deadline = Instant::now() + STOP_LIMIT;
        self.mission_threads.stop(deadline);
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
        self.persistence.end(&self.environment);
        self.record_end(reason);
        summary.recording = self.recording.take().map(RecordingThread::finish);
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
        if let Some(recording) = self.recording {
            // Of a run that did not start: what there is of it tells why.
            let _not_summed_up = recording.finish();
        }
        self.crew.dismiss();
        self.environment.events.finish();
        self.writer.close()
    }

    fn notice(&self, message: &str) {
        self.record(Event::Notice {
            message: message.to_owned(),
        });
    }

    fn record(&self, event: Event) {
        let now_ns = self.environment.clock.now_ns();
        self.environment.events.record(now_ns, event);
    }
}
