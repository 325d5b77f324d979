//! Whether a run is over, why, and what it came to.

use std::ops::Range;

use super::System;
use crate::summary::{ApplicationSummary, ComponentSummary, Summary, application_state};

impl System {
    pub(super) fn is_over(&self) -> bool {
        let reached = self.environment.worlds.have_reached_targets();
        let elapsed = self
            .options
            .duration
            .is_some_and(|duration| self.now() >= duration);
        reached || elapsed
    }

    pub(super) fn reason(&self) -> &'static str {
        if self.environment.worlds.have_reached_targets() {
            "target_reached"
        } else {
            "duration_elapsed"
        }
    }

    pub(super) fn summary(&self, ended_by: &'static str) -> Summary {
        let application = |members: &Range<usize>| ApplicationSummary {
            state: application_state(&self.statuses[members.clone()]),
            ended_by,
            time_s: self.now().as_secs_f64(),
            clock: self.options.clock.name(),
            seed: self.options.seed,
            events_lost: self.environment.events.lost(),
        };
        let applications = self.applications.iter();
        let worlds = &self.environment.worlds;
        let several = worlds.are_several().then_some(worlds);
        Summary {
            applications: applications
                .map(|(name, members)| (name.clone(), application(members)))
                .collect(),
            components: self
                .statuses
                .iter()
                .map(|status| (status.name.clone(), ComponentSummary::of(status)))
                .collect(),
            restarts: self.restarts(),
            robot: worlds.first().map(|world| world.summary()),
            robots: several
                .map(|it| it.summaries().collect())
                .unwrap_or_default(),
            adaptation: self.environment.adaptation_requests.summary(),
            recording: None,
        }
    }
}
