//! State 1 of the decider: whether what runs still does.

use std::time::Duration;

use system_model::task::{Placement, TaskSpecification};

use crate::estimate::Answer;
use crate::judge::judge;

/// Bad evaluations in a row. One that is good by less than the hysteresis neither counts nor
/// ends the row, so that a performance that wavers about its threshold is found bad once.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BadEvaluations {
    count: u32,
    since: Duration,
}

impl BadEvaluations {
    /// How many there are.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    /// Takes an evaluation of what runs.
    pub(crate) fn take(
        &mut self,
        task: &TaskSpecification,
        running: &[Placement],
        answer: &Answer,
        now: Duration,
    ) {
        let (quality, rejections) = judge(task, running, answer);
        let clearly = 1.0 + task.decision.hysteresis;
        let is_clearly_good = quality.is_some_and(|quality| {
            quality.functional > task.quality.functional_threshold * clearly
                && quality.non_functional > task.quality.non_functional_threshold * clearly
        });
        match (rejections.is_empty() && quality.is_some(), is_clearly_good) {
            (false, _) => {
                if self.count == 0 {
                    self.since = now;
                }
                self.count = self.count.saturating_add(1);
            }
            (true, true) => self.count = 0,
            (true, false) => {}
        }
    }

    /// Since when, if the last ones were bad.
    pub(crate) fn since(&self) -> Option<Duration> {
        (self.count > 0).then_some(self.since)
    }
}
