//! What only runs by the machine's clock need: a thread for the world, priorities, fine timers.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use crate::component::Environment;
use crate::event_log::Event;
use crate::executor::Executor;
use crate::scheduling;
use crate::status::{ComponentStatus, Meter};

/// Moves the worlds along with the machine's clock.
pub(super) struct WorldThread {
    stopping: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl WorldThread {
    /// None without a world.
    pub(super) fn start(environment: Arc<Environment>) -> io::Result<Option<Self>> {
        let stopping = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stopping);
        let Some(period) = environment.worlds.step_period() else {
            return Ok(None);
        };
        let thread = std::thread::Builder::new()
            .name("world".to_owned())
            .spawn(move || {
                while !asked.load(Ordering::Acquire) {
                    (environment.worlds).advance_to(environment.clock.now(), &environment);
                    std::thread::sleep(period);
                }
            })?;
        Ok(Some(Self { stopping, thread }))
    }

    pub(super) fn stop(self) {
        self.stopping.store(true, Ordering::Release);
        // It ends within one step of the world; a panic in it has been printed.
        let _panicked = self.thread.join();
    }
}

/// What the executor's thread does first, and every thread that takes over from it: asks for the
/// scheduling that the profile wants, and says so where it is refused.
pub(super) fn preparation(
    executor: &Executor,
    environment: Arc<Environment>,
) -> impl Fn() + Send + Sync + 'static {
    let (name, policy, priority) = (executor.name.clone(), executor.policy, executor.priority);
    move || {
        scheduling::wake_in_time();
        if let Err(reason) = scheduling::set(policy, priority) {
            let message = format!(
                "executor '{name}' asked for real-time scheduling and runs without it: {reason}"
            );
            let now_ns = environment.clock.now_ns();
            environment.events.record(now_ns, Event::Notice { message });
        }
    }
}

/// What measures rates and loads of these components.
pub(super) fn meter(statuses: &[Arc<ComponentStatus>], executors: &[Executor]) -> Meter {
    let runs = |executor: &Executor, component: usize| {
        let members = executor.members.iter();
        let mut numbers = members.map(|member| usize::try_from(member.number));
        numbers.any(|number| number == Ok(component))
    };
    let executor_of = |component| {
        let position = executors.iter().position(|one| runs(one, component));
        // Every component is in an executor.
        position.unwrap_or(usize::MAX)
    };
    Meter::new(
        statuses.to_vec(),
        executors
            .iter()
            .map(|one| Arc::clone(&one.status))
            .collect(),
        (0..statuses.len()).map(executor_of).collect(),
    )
}
