//! A run in which nothing is due any more.

use super::Simulated;
use crate::lane::Lane;

impl Simulated {
    /// Lets the world move until the run ends.
    pub(super) fn idle_until_end(&self, lane: &Lane) {
        /// Steps in which an idle run goes to its end, so that it can be stopped.
        const IDLE_STEP_NS: u64 = 100_000_000;
        if self.end_ns == u64::MAX {
            return;
        }
        while !lane.is_stopping() {
            let next = self.environment.clock.now_ns().saturating_add(IDLE_STEP_NS);
            if !self.advance(next) {
                return;
            }
        }
    }
}
