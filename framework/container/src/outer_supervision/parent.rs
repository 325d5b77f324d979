//! The parent: starts the container, watches it, restarts it.

mod container;
mod plan;
mod record;

use std::io;
use std::os::fd::AsFd as _;
use std::path::PathBuf;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::Signal;

use super::budget::{Budget, RESTART_WINDOW};
use super::hardware_watchdog::HardwareWatchdog;
use super::judgement::{End, Judgement, judge};
use super::liveness::{Limits, Phase, START_LIMIT, STOP_LIMIT};
use super::messages::{Death, Welcome};
use super::monotonic;
use super::safe_states::SafeStates;
use super::service_manager::ServiceManager;
use super::signals::Signals;
use super::world_process::{NoWorld, WorldProcess};
use crate::clock::nanoseconds;
use container::Container;

pub use plan::{GIVEN_UP, Plan, PlannedWorld, SuperviseError};

/// Supervises a container to the end of its run: the exit code that says how it ended. Must be called
/// on the main thread of the process, for the children die with the thread.
///
/// # Errors
/// If that is not possible (any more).
pub fn supervise(plan: Plan) -> Result<u8, SuperviseError> {
    let signals = Signals::watch()?;
    let start = monotonic();
    let file = |path: &PathBuf, error| SuperviseError::File {
        path: path.clone(),
        error,
    };
    if let Some(path) = &plan.events {
        // What an earlier run has left there is not of this one; containers only go on in it.
        std::fs::File::create(path).map_err(|error| file(path, error))?;
    }
    let armed = plan.hardware_watchdog.as_ref();
    let armed = armed.map(|path| {
        let armed = HardwareWatchdog::arm(path, start);
        armed.map_err(|error| file(path, error))
    });
    let world = plan.world.as_ref();
    let world = world.map(|world| WorldProcess::start(&plan.executable, world));
    let mut parent = Parent {
        budget: Budget::new(plan.restarts),
        safe_states: SafeStates::new(plan.safe_states.clone()),
        service_manager: ServiceManager::of_environment(start)?,
        hardware_watchdog: armed.transpose()?,
        world: match world.transpose() {
            Ok(world) => world,
            Err(NoWorld::Refused(code)) => return Ok(code),
            Err(NoWorld::System(error)) => return Err(error.into()),
        },
        signals,
        start,
        restarts: 0,
        is_stopping: false,
        plan,
    };
    let code = parent.run()?;
    match parent.hardware_watchdog.take() {
        // Given up is no orderly end: the machine is to be reset.
        Some(watchdog) if code != GIVEN_UP => {
            watchdog.disarm()?;
        }
        _ => {}
    }
    Ok(code)
}

struct Parent {
    plan: Plan,
    budget: Budget,
    safe_states: SafeStates,
    service_manager: ServiceManager,
    hardware_watchdog: Option<HardwareWatchdog>,
    world: Option<WorldProcess>,
    signals: Signals,
    /// When this process began, by the monotonic clock.
    start: Duration,
    restarts: u32,
    /// A signal has asked for the end of the run.
    is_stopping: bool,
}

impl Parent {
    /// One container after the other, until one ends in order or the budget is used up.
    fn run(&mut self) -> Result<u8, SuperviseError> {
        let mut death = None;
        loop {
            let mut container = self.start_container(death.take())?;
            let end = self.watch(&mut container)?;
            let seen = monotonic();
            let judged = match judge(end, container.circumstances(self.restarts > 0)) {
                Judgement::Over(code) => {
                    // One that did not stop in order may have left actuators moving.
                    if !matches!(end, End::Code(_)) {
                        self.hold_safe_states(seen);
                    }
                    return Ok(code);
                }
                Judgement::Failed(judged) => judged,
            };
            self.hold_safe_states(seen);
            crate::control::remove_sockets_of_the_dead();
            let Some(number) = self.budget.take(seen) else {
                self.give_up(&end, judged);
                return Ok(GIVEN_UP);
            };
            self.restarts += 1;
            let most = self.budget.most();
            let window_s = RESTART_WINDOW.as_secs();
            let next = Death {
                seen: end.to_string(),
                judged,
                done: format!(
                    "restart {number} of at most {most} within {window_s} s{}",
                    record::held(&self.safe_states.devices())
                ),
                heard_ns: nanoseconds(container.heard()),
                seen_ns: nanoseconds(seen),
                restarted_ns: 0,
            };
            self.say(&format!(
                "the container has failed: {}: {}",
                next.seen, next.done
            ));
            death = Some(next);
        }
    }

    fn start_container(&mut self, death: Option<Death>) -> Result<Container, SuperviseError> {
        let world = self.world.as_mut().map(WorldProcess::connect).transpose()?;
        let now = monotonic();
        let welcome = Welcome {
            first_start_ns: nanoseconds(self.start),
            restarts: self.restarts,
            death: death.map(|death| Death {
                restarted_ns: nanoseconds(now),
                ..death
            }),
        };
        let limits = Limits {
            start: START_LIMIT,
            beat: self.plan.beat_limit,
            stop: STOP_LIMIT,
        };
        let container = Container::start(&self.plan, limits, &welcome, world, now)?;
        self.service_manager
            .status(&format!("starting, {} restarts", self.restarts));
        Ok(container)
    }

    /// Watches a container to its end.
    fn watch(&mut self, container: &mut Container) -> Result<End, SuperviseError> {
        let mut world_ended = false;
        loop {
            let [ended, world_is_gone] = self.wait(container, world_ended)?;
            let now = monotonic();
            // Before it is judged silent: it may have been this process that did not run.
            let phase = container.listen(now);
            self.follow(phase);
            for signal in self.signals.take() {
                self.stop(container, signal, now);
            }
            if world_is_gone && !world_ended {
                world_ended = true;
                self.stop(container, Signal::TERM, now);
            }
            if ended {
                let end = container.end()?;
                return match world_ended {
                    true => Err(SuperviseError::WorldEnded),
                    false => Ok(end),
                };
            }
            if container.is_overdue(now) && !container.kill_overdue(now) {
                return Err(SuperviseError::DoesNotEnd);
            }
            if container.is_killed() {
                self.hold_safe_states(now);
            } else {
                self.write_safe_states(now);
                self.feed_watchdogs(now);
            }
        }
    }

    /// Waits until something happens or is due: whether the container has ended, and the world.
    fn wait(&self, container: &Container, without_world: bool) -> io::Result<[bool; 2]> {
        let world = self.world.as_ref().filter(|_| !without_world);
        let ends = [container.process().as_fd()].into_iter();
        let ends = ends.chain(world.map(|world| world.as_fd()));
        let words = container.line().into_iter();
        let words = words.chain(self.signals.descriptors());
        let mut descriptors: Vec<PollFd<'_>> = (ends.chain(words))
            .map(|descriptor| PollFd::from_borrowed_fd(descriptor, PollFlags::IN))
            .collect();
        let due = [
            Some(container.due()),
            self.safe_states.due(),
            self.service_manager.due(),
            self.hardware_watchdog.as_ref().map(HardwareWatchdog::due),
        ];
        let due = due.into_iter().flatten().min().unwrap_or_default();
        let timeout = Timespec::try_from(due.saturating_sub(monotonic())).ok();
        match poll(&mut descriptors, timeout.as_ref()) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
        let is_ready = |index: usize| {
            let descriptor: Option<&PollFd<'_>> = descriptors.get(index);
            descriptor.is_some_and(|descriptor| !descriptor.revents().is_empty())
        };
        Ok([is_ready(0), world.is_some() && is_ready(1)])
    }

    /// The container has entered a phase.
    fn follow(&mut self, phase: Option<Phase>) {
        match phase {
            Some(Phase::Running) => {
                self.safe_states.release();
                self.service_manager.ready();
                self.service_manager
                    .status(&format!("running, {} restarts", self.restarts));
            }
            Some(Phase::Stopping) => self.service_manager.stopping(),
            Some(Phase::Starting) | None => {}
        }
    }

    /// Asks the container to stop in order.
    fn stop(&mut self, container: &mut Container, signal: Signal, now: Duration) {
        container.ask_to_stop(signal, now);
        if !std::mem::replace(&mut self.is_stopping, true) {
            self.service_manager.stopping();
        }
    }

    /// No container runs from `now` on.
    fn hold_safe_states(&mut self, now: Duration) {
        self.safe_states.hold(now);
        self.write_safe_states(now);
    }

    fn write_safe_states(&mut self, now: Duration) {
        self.safe_states.write(now);
        let complaints: Vec<String> = self.safe_states.complaints().collect();
        for complaint in complaints {
            self.say(&complaint);
        }
    }

    fn feed_watchdogs(&mut self, now: Duration) {
        self.service_manager.feed(now);
        if let Some(watchdog) = &mut self.hardware_watchdog {
            watchdog.feed(now);
        }
    }

    fn give_up(&mut self, end: &End, judged: String) {
        let most = self.budget.most();
        let seen = end.to_string();
        let text = format!(
            "the container has failed: {seen}; all {most} restarts within {} s are used up: given up\n  \
             help: 'steadfast run' without --supervised shows what happens; --restarts N allows more",
            RESTART_WINDOW.as_secs()
        );
        self.say(&text);
        self.service_manager.status(&text);
        self.service_manager.stopping();
        let run_time = monotonic().saturating_sub(self.start);
        if let Some(path) = &self.plan.events
            && let Err(error) = record::given_up(path, run_time, self.restarts, seen, judged)
        {
            self.say(&format!("{} cannot be written: {error}", path.display()));
        }
    }

    fn say(&self, text: &str) {
        record::say(text);
    }
}
