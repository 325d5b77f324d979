//! The stages of an application's life: bringing up, launching the executors, shutting down.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use crossbeam::channel::Receiver;
use fault_manager::Observation;
use system_model::life_cycle::Operation;
use system_model::specification::{ExecutionKind, SchedulingPolicy};

use super::agenda::{Agenda, Failure, Step};
use super::persistence::Persistence;
use super::real_time::{self, WorldThread};
use super::{BRING_UP_LIMIT, ClockKind, STOP_LIMIT, StartError, System};
use crate::adaptation::Adaptation;
use crate::event_log::Event;
use crate::executor::Executor;
use crate::lane::{Lane, SETUP_TOKEN, remaining};
use crate::mission::{Caller, Runner};
use crate::schedule::{RealTime, Simulated};

impl System {
    /// Brings all up and lets them run.
    pub(super) fn begin(
        mut self,
        executors: Vec<Executor>,
        adaptations: Vec<Adaptation>,
        runners: Vec<Runner>,
        wanted: Receiver<usize>,
    ) -> Result<Self, StartError> {
        if let Err(error) = self.bring_up() {
            // The refusal counts; a log that cannot be written either does not change it.
            let _log_error = self.close();
            return Err(error);
        }
        if let Err(error) = self.launch(executors, adaptations, runners, wanted) {
            // What is on the disk is for the next try.
            self.persistence = Persistence::default();
            let _nothing_to_sum_up = self.stop("start_refused");
            return Err(error);
        }
        let supervised = self.options.supervised.as_ref();
        if let Some(restarted) = supervised.and_then(|it| it.runs()) {
            self.record(restarted);
        }
        Ok(self)
    }

    /// Constructs and initialises all, then starts all. A component that traps or panics is in
    /// ERROR and the rest goes on; one that says no stops the whole start.
    fn bring_up(&mut self) -> Result<(), StartError> {
        for (name, members) in &self.applications {
            self.record(Event::RunStarted {
                application: name.clone(),
                clock: self.options.clock.name(),
                seed: self.options.seed,
                components: members.len(),
            });
        }
        self.begin_injections();
        self.bring_up_by_steps().inspect_err(|_| {
            self.shut_down(STOP_LIMIT);
            self.record_end("start_refused");
        })
    }

    fn bring_up_by_steps(&mut self) -> Result<(), StartError> {
        self.perform_all(&[Step::Construct, Step::Operate(Operation::Initialize)])?;
        let (options, environment) = (&self.options.state, &self.environment);
        self.persistence
            .open(options, &self.components, environment)?;
        self.perform_all(&[Step::Inherit])?;
        self.perform_all(&[Step::Standby])?;
        self.perform_all(&[Step::Operate(Operation::Start)])?;
        self.check_backups()
    }

    fn perform_all(&self, steps: &[Step]) -> Result<(), StartError> {
        let failures = self.perform(steps, false, BRING_UP_LIMIT)?;
        if failures.is_empty() {
            Ok(())
        } else {
            Err(StartError::Components(failures))
        }
    }

    /// A backup of a component that registers no memory would never hold anything: only now that it
    /// has been started is that known.
    fn check_backups(&self) -> Result<(), StartError> {
        let in_vain = self.components.iter().filter_map(|cell| {
            let component = cell.enter(SETUP_TOKEN, Duration::ZERO)?;
            component
                .keeps_checkpoints_of_nothing()
                .then(|| component.name().to_string())
        });
        let components: Vec<String> = in_vain.collect();
        if components.is_empty() {
            Ok(())
        } else {
            Err(StartError::NothingToBackUp { components })
        }
    }

    /// What is to go wrong from the start goes wrong while the components are brought up.
    fn begin_injections(&self) {
        let environment = &self.environment;
        if environment.injections.is_armed() {
            let worlds = &environment.worlds;
            let begun = environment.injections.advance(self.now(), worlds);
            environment.record_injections(&begun);
        }
    }

    /// Puts on record why it is over, and what of it is not on record.
    pub(super) fn record_end(&self, reason: &'static str) {
        let dropped = self.environment.observations.dropped();
        if dropped > 0 {
            self.notice(&format!(
                "{dropped} symptoms were not judged: too many came at once"
            ));
        }
        let not_recorded = self.recording.as_ref().map_or(0, |it| it.dropped());
        if not_recorded > 0 {
            self.notice(&format!(
                "{not_recorded} data were not recorded: they came faster than they could be written"
            ));
        }
        let events_lost = self.environment.events.lost();
        self.environment.events.record(
            self.environment.clock.now_ns(),
            Event::RunStopped {
                reason,
                events_lost,
            },
        );
    }

    /// Stops and destroys all, last first. Each one that hangs takes the whole `limit`, so after
    /// twice that the rest is left as it is.
    pub(super) fn shut_down(&self, limit: Duration) {
        let deadline = Instant::now() + 2 * limit;
        for operation in [Operation::Stop, Operation::Destroy] {
            // A component that fails while it is stopped is on record; one that hangs is left
            // behind, and the others still get their turn.
            while let Err(StartError::Hangs { component }) =
                self.perform(&[Step::Operate(operation)], true, limit)
            {
                self.notice(&format!(
                    "component '{component}' did not return: it is left behind, not stopped"
                ));
                if remaining(deadline).is_zero() {
                    return;
                }
            }
        }
    }

    /// Performs steps on all components, on a lane of their own so that a hang or a lost thread
    /// does not take the container along.
    fn perform(
        &self,
        steps: &[Step],
        last_first: bool,
        limit: Duration,
    ) -> Result<Vec<Failure>, StartError> {
        let agenda = Agenda::new(
            Arc::clone(&self.components),
            steps.to_vec(),
            last_first,
            Arc::clone(&self.left_behind),
            Arc::clone(&self.supervisor),
        );
        let (failures, progress) = (agenda.failures(), agenda.progress());
        let lane = Lane::new("life-cycle", Box::new(agenda));
        self.crew.start(&lane, || {})?;
        if lane.wait(limit) {
            return Ok(failures.take());
        }
        // Should it ever come back, its lane goes no further than the step it is in.
        lane.stop();
        let component = progress.component();
        self.left_behind[component].store(true, Ordering::Release);
        Err(StartError::Hangs {
            component: self.statuses[component].name.clone(),
        })
    }

    fn launch(
        &mut self,
        executors: Vec<Executor>,
        adaptations: Vec<Adaptation>,
        runners: Vec<Runner>,
        wanted: Receiver<usize>,
    ) -> Result<(), StartError> {
        self.environment.observations.report(Observation::Running);
        match self.options.clock {
            ClockKind::Simulated => {
                let work = Simulated::new(
                    executors,
                    adaptations,
                    Arc::clone(&self.components),
                    Arc::clone(&self.supervisor),
                    self.options.duration,
                )
                .with_trees(runners, Arc::clone(&self.calls));
                let lane = Lane::new("simulated", Box::new(work));
                self.crew.start(&lane, || {})?;
                let members = (0..self.components.len()).collect();
                self.lanes.push((lane, members));
            }
            ClockKind::Real => {
                let supervised = self.options.supervised.clone();
                let is_real_time = |one: &&Executor| one.policy != SchedulingPolicy::Other;
                let real_time = executors.iter().filter(is_real_time);
                let above = real_time.map(|one| one.priority).max();
                let has_thread = |one: &&Executor| one.kind != ExecutionKind::Passive;
                let all = executors
                    .iter()
                    .filter(has_thread)
                    .all(|one| is_real_time(&one));
                let threads = &mut self.manager_threads;
                threads.start(&self.supervisor, &self.crew, wanted, above, all, supervised)?;
                if above.is_some() {
                    self.lock_memory();
                }
                self.world_thread = WorldThread::start(Arc::clone(&self.environment))?;
                for executor in executors {
                    self.launch_executor(executor)?;
                }
                for adaptation in adaptations {
                    self.launch_adaptation(adaptation)?;
                }
                if self.calls.is_used() {
                    self.launch_caller()?;
                }
                for runner in runners {
                    let environment = Arc::clone(&self.environment);
                    self.mission_threads.start(runner, environment)?;
                }
            }
        }
        Ok(())
    }

    fn launch_caller(&mut self) -> Result<(), StartError> {
        let calls = Arc::clone(&self.calls);
        let environment = Arc::clone(&self.environment);
        let work = Caller::new(calls, Arc::clone(&self.components), environment);
        let lane = Lane::new("tree calls", Box::new(work));
        self.crew.start(&lane, || {})?;
        self.lanes.push((lane, Vec::new()));
        Ok(())
    }

    fn launch_executor(&mut self, executor: Executor) -> Result<(), StartError> {
        let prepare = real_time::preparation(&executor, Arc::clone(&self.environment));
        let name = executor.name.clone();
        let orders = Arc::clone(&executor.orders);
        let members = executor
            .members
            .iter()
            .map(|member| member.number as usize)
            .collect();
        let work = RealTime::new(
            executor,
            Arc::clone(&self.components),
            Arc::clone(&self.supervisor),
        );
        let lane = Lane::new(name, Box::new(work));
        orders.attach(&lane);
        self.crew.start(&lane, prepare)?;
        self.lanes.push((lane, members));
        Ok(())
    }

    /// Pages that are swapped out or not there yet would stop a real-time thread for milliseconds.
    /// Stacks and buffers are locked as they are touched, not all at once.
    fn lock_memory(&self) {
        use rustix::mm::{MlockAllFlags, mlockall};
        let flags = MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT;
        if let Err(error) = mlockall(flags) {
            self.notice(&format!(
                "memory cannot be locked ({error}): real-time executors may wait for pages"
            ));
        }
    }
}
