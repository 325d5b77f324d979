//! The lane of an adaptation where time is real: it runs code of components, which may be lost.

use std::sync::Arc;
use std::time::Duration;

use super::shell::Adaptation;
use crate::component::{ComponentCell, Environment, mark_lost};
use crate::guard::loss::LostThread;
use crate::lane::{Lane, Work};
use crate::wake::Wake;

/// It sleeps at most this long, so that it notices being stopped even if no word reaches it.
const LONGEST_SLEEP: Duration = Duration::from_millis(100);

/// What the lane does.
pub struct AdaptationLane {
    adaptation: Adaptation,
    components: Arc<[Arc<ComponentCell>]>,
    environment: Arc<Environment>,
    wake: Arc<Wake>,
}

impl AdaptationLane {
    /// Not begun.
    pub fn new(
        adaptation: Adaptation,
        components: Arc<[Arc<ComponentCell>]>,
        environment: Arc<Environment>,
    ) -> Self {
        Self {
            wake: adaptation.wake().unwrap_or_default(),
            adaptation,
            components,
            environment,
        }
    }
}

impl Work for AdaptationLane {
    fn run(&mut self, lane: &Lane) {
        while !lane.is_stopping() {
            self.adaptation.look(lane);
            let now_ns = self.environment.clock.now_ns();
            let sleep_ns = self.adaptation.due_ns().saturating_sub(now_ns);
            self.wake
                .sleep(Duration::from_nanos(sleep_ns).min(LONGEST_SLEEP));
            self.wake.take();
        }
    }

    fn after_loss(&mut self, lost: &LostThread) {
        if !self.adaptation.after_loss() {
            mark_lost(&self.components, lost, false);
        }
    }

    fn waker(&self) -> Option<Arc<Wake>> {
        Some(Arc::clone(&self.wake))
    }
}
