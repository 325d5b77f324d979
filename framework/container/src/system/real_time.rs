//! What only runs by the machine's clock need: a thread for the world, priorities, fine timers.

use std::io;
use std::num::NonZeroU64;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use system_model::specification::SchedulingPolicy;
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use crate::component::Environment;
use crate::event_log::Event;
use crate::executor::Executor;
use crate::world::World;

/// Moves the world along with the machine's clock.
pub(super) struct WorldThread {
    stopping: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl WorldThread {
    pub(super) fn start(world: Arc<World>, environment: Arc<Environment>) -> io::Result<Self> {
        let stopping = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stopping);
        let period = world.step_period();
        let thread = std::thread::Builder::new()
            .name("world".to_owned())
            .spawn(move || {
                while !asked.load(Ordering::Acquire) {
                    world.advance_to(environment.clock.now(), &environment);
                    std::thread::sleep(period);
                }
            })?;
        Ok(Self { stopping, thread })
    }

    pub(super) fn stop(self) {
        self.stopping.store(true, Ordering::Release);
        // It ends within one step of the world; a panic in it has been printed.
        let _panicked = self.thread.join();
    }
}

/// What the executor's thread does first: asks for the scheduling that the profile wants, and says
/// so where it is refused.
pub(super) fn preparation(
    executor: &Executor,
    environment: Arc<Environment>,
) -> impl FnOnce() + Send + 'static {
    let (name, policy, priority) = (executor.name.clone(), executor.policy, executor.priority);
    move || {
        set_timer_slack();
        let real_time = match policy {
            SchedulingPolicy::Other => return,
            SchedulingPolicy::Fifo => RealtimeThreadSchedulePolicy::Fifo,
            SchedulingPolicy::RoundRobin => RealtimeThreadSchedulePolicy::RoundRobin,
        };
        // The kernel's real-time priorities begin at 1.
        let value = ThreadPriorityValue::try_from(priority.clamp(1, 99));
        let refused = match value {
            Ok(value) => set_thread_priority_and_policy(
                thread_native_id(),
                ThreadPriority::Crossplatform(value),
                ThreadSchedulePolicy::Realtime(real_time),
            )
            .err()
            .map(|error| format!("{error:?}")),
            Err(reason) => Some(reason.to_owned()),
        };
        if let Some(reason) = refused {
            let message = format!(
                "executor '{name}' asked for real-time scheduling and runs without it: {reason}"
            );
            let now_ns = environment.clock.now_ns();
            environment.events.record(now_ns, Event::Notice { message });
        }
    }
}

/// Asks for wake-ups at the time that was asked for: by default the kernel may be 50 us late to
/// save energy. Refused nowhere that is known; a refusal would only make cycles less even.
fn set_timer_slack() {
    let _less_even = rustix::thread::set_current_timer_slack(NonZeroU64::new(1));
}
