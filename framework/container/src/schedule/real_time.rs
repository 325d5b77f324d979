//! An executor on a thread of its own, by the machine's clock.

use std::sync::Arc;
use std::time::Duration;

use crate::clock::nanoseconds;
use crate::component::{ComponentCell, Environment};
use crate::event_log::Event;
use crate::executor::Executor;
use crate::guard::loss::LostThread;
use crate::lane::{Lane, Work};
use crate::supervision::{Supervisor, rehearse};
use crate::wake::Wake;

/// An executor that nothing is due for sleeps at most this long, so that it notices being stopped
/// even if no word reaches it.
const LONGEST_SLEEP: Duration = Duration::from_millis(500);

/// An executor on a thread of its own.
pub struct RealTime {
    executor: Executor,
    components: Arc<[Arc<ComponentCell>]>,
    environment: Arc<Environment>,
    supervisor: Arc<Supervisor>,
    /// When the next cycle (or the one that was cut off) is or was due.
    release_ns: u64,
}

impl RealTime {
    /// Not begun; the first cycle is due at once.
    pub fn new(
        executor: Executor,
        components: Arc<[Arc<ComponentCell>]>,
        supervisor: Arc<Supervisor>,
    ) -> Self {
        Self {
            executor,
            components,
            environment: Arc::clone(supervisor.environment()),
            supervisor,
            release_ns: 0,
        }
    }

    fn period_ns(&self) -> u64 {
        nanoseconds(self.executor.period)
    }

    /// Sleeps until something is due; false if the lane is to stop.
    fn wait(&mut self, lane: &Lane) -> bool {
        loop {
            if lane.is_stopping() {
                return false;
            }
            self.serve(lane);
            let now_ns = self.environment.clock.now_ns();
            let periodic = self.period_ns() > 0;
            if periodic && now_ns >= self.release_ns {
                return true;
            }
            // Events and orders wake a periodic executor too: the former wait for its next cycle.
            if self.executor.wake.take() && !periodic {
                self.release_ns = now_ns;
                return true;
            }
            if !self.executor.orders.is_empty() {
                continue;
            }
            let sleep = if periodic {
                Duration::from_nanos(self.release_ns - now_ns)
            } else {
                LONGEST_SLEEP
            };
            self.executor.wake.sleep(sleep.min(LONGEST_SLEEP));
            if !periodic {
                self.executor.look_after(lane);
            }
        }
    }

    /// Lets the fault manager see what happened, and does what it asks.
    #[inline]
    fn serve(&mut self, lane: &Lane) {
        self.supervisor.attend();
        if !self.executor.orders.is_empty() {
            self.executor.obey(&self.supervisor, lane);
        }
    }

    /// Sets the next release; a cycle that took longer than its period is reported, and the next
    /// one is due at once, without a burst to catch up.
    fn finish_cycle(&mut self, began_ns: u64, lane: &Lane) {
        let period_ns = self.period_ns();
        if period_ns == 0 {
            return;
        }
        let now_ns = self.environment.clock.now_ns();
        self.executor.status.add_busy_ns(now_ns - began_ns);
        let next_ns = self.release_ns + period_ns;
        if now_ns <= next_ns {
            self.release_ns = next_ns;
            return;
        }
        self.executor.overran(lane);
        let overrun = Event::Overrun {
            executor: self.executor.name.clone(),
            cycle: self.executor.cycles,
            late_ns: now_ns - next_ns,
        };
        self.environment.events.record(now_ns, overrun);
        self.release_ns = now_ns;
    }
}

impl Work for RealTime {
    fn run(&mut self, lane: &Lane) {
        if self.release_ns == 0 {
            // Without room for it the first fault takes a little longer, and nothing else.
            let _unrehearsed = rehearse(lane);
            self.release_ns = self.environment.clock.now_ns();
        }
        while self.executor.is_in_cycle() || self.wait(lane) {
            let now_ns = self.environment.clock.now_ns();
            while self.executor.step(now_ns, lane) {
                self.serve(lane);
            }
            self.finish_cycle(now_ns, lane);
        }
    }

    fn after_loss(&mut self, lost: &LostThread) {
        self.executor
            .after_loss(&self.components, lost, &self.supervisor);
    }

    fn waker(&self) -> Option<Arc<Wake>> {
        Some(Arc::clone(&self.executor.wake))
    }
}
