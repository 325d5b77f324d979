//! Whether a run is over, why, and what it came to.

use std::ops::Range;

use super::System;
use crate::summary::{ApplicationSummary, ComponentSummary, Summary, application_state};

impl System {
    pub(super) fn is_over(&self) -> bool {
        let reached = self
            .world
            .as_ref()
            .is_some_and(|world| world.has_reached_target());
        let elapsed = self
            .options
            .duration
            .is_some_and(|duration| self.now() >= duration);
        reached || elapsed
    }

    pub(super) fn reason(&self) -> &'static str {
        let reached = self
            .world
            .as_ref()
            .is_some_and(|world| world.has_reached_target());
        if reached {
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
            robot: self.world.as_ref().map(|world| world.summary()),
            adaptation: self.environment.adaptation_requests.summary(),
            recording: None,
        }
    }
}
