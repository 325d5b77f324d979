//! What is known of a running system.

use std::sync::Arc;
use std::time::Duration;

use super::System;
use crate::control::RunningSystem;
use crate::status::ComponentStatus;
use crate::supervision::Supervisor;
use crate::world::Worlds;

impl System {
    /// The name of the application; of several, all of them with `+` in between.
    pub fn name(&self) -> &str {
        &self.specification.name
    }

    /// What the container knows of each component.
    pub fn statuses(&self) -> &[Arc<ComponentStatus>] {
        &self.statuses
    }

    /// Time by the application's clock.
    pub fn now(&self) -> Duration {
        self.environment.clock.now()
    }

    /// The fault manager's shell.
    pub fn supervisor(&self) -> &Arc<Supervisor> {
        &self.supervisor
    }

    /// What an operator may ask of it while it runs.
    pub fn control(&self) -> RunningSystem {
        RunningSystem {
            meter: Arc::clone(&self.meter),
            links: Arc::clone(&self.links),
            began: self.began,
            restarts: self.restarts(),
            specification: self.specification.clone(),
            applications: self.applications.clone(),
            interfaces: Arc::clone(&self.interfaces),
            statuses: self.statuses.clone(),
            trees: self.trees.clone(),
            supervisor: Arc::clone(&self.supervisor),
        }
    }

    /// The simulated worlds.
    pub fn worlds(&self) -> &Worlds {
        &self.environment.worlds
    }

    pub(super) fn restarts(&self) -> u32 {
        (self.options.supervised.as_ref()).map_or(0, |it| it.restarts())
    }
}
