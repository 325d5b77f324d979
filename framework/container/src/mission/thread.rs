//! Where time is real each tree has a thread of its own, an ordinary one: it disturbs no executor of
//! real-time rank, and a tree that hangs holds up nobody else.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::runner::Runner;
use crate::clock::nanoseconds;
use crate::component::Environment;

/// The longest sleep, so that orders are taken and the end is noticed.
const LONGEST_SLEEP: Duration = Duration::from_millis(10);

/// The threads, once started.
#[derive(Default)]
pub struct MissionThreads {
    stopping: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl MissionThreads {
    /// Starts a thread for a tree.
    ///
    /// # Errors
    /// If the system refuses it.
    pub fn start(&mut self, runner: Runner, environment: Arc<Environment>) -> io::Result<()> {
        let stopping = Arc::clone(&self.stopping);
        let thread = std::thread::Builder::new()
            .name(format!("tree {}", runner.name()))
            .spawn(move || run(runner, &environment, &stopping))?;
        self.threads.push(thread);
        Ok(())
    }

    /// Halts all trees; one that has not ended at `deadline` is left behind.
    pub fn stop(&mut self, deadline: Instant) {
        self.stopping.store(true, Ordering::Release);
        for thread in self.threads.drain(..) {
            while !thread.is_finished() && Instant::now() < deadline {
                std::thread::sleep(Duration::from_millis(1));
            }
            if thread.is_finished() {
                // A panic outside a tick has been printed.
                let _panicked = thread.join();
            }
        }
    }
}

fn run(mut runner: Runner, environment: &Environment, stopping: &AtomicBool) {
    runner.begin();
    while !stopping.load(Ordering::Acquire) {
        runner.obey();
        runner.tick();
        let now_ns = environment.clock.now_ns();
        let limit_ns = nanoseconds(LONGEST_SLEEP);
        let due_ns = runner.due_ns().unwrap_or(u64::MAX);
        let sleep_ns = due_ns.saturating_sub(now_ns).min(limit_ns);
        std::thread::sleep(Duration::from_nanos(sleep_ns));
    }
    runner.stop();
}
