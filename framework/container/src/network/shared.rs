//! What the threads of the network and the tasks share.

use std::sync::atomic::{AtomicBool, AtomicU64};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::task_line::{Gates, Tasks};
use crate::component::Environment;
use crate::event_log::Event;
use crate::wake::Wake;

/// What the threads share.
pub(super) struct Shared {
    pub(super) robot: String,
    pub(super) incarnation: u64,
    /// Term in which data are sent.
    pub(super) term: AtomicU64,
    pub(super) stopping: Arc<AtomicBool>,
    pub(super) environment: Arc<Environment>,
    pub(super) gates: Gates,
    pub(super) tasks: Mutex<Tasks>,
    pub(super) team: Mutex<TeamView>,
    /// What tells tasks of something new.
    pub(super) wakes: Mutex<Vec<Arc<Wake>>>,
}

/// Who is there and who decides.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct TeamView {
    /// None until all have had time to be heard.
    pub(super) decider: Option<String>,
    pub(super) alive: Vec<String>,
}

impl Shared {
    pub(super) fn team(&self) -> MutexGuard<'_, TeamView> {
        self.team.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What becomes awake when there is something new.
    pub(super) fn wake_of_tasks(&self) -> Arc<Wake> {
        let wake = Arc::default();
        let mut wakes = self.wakes.lock().unwrap_or_else(PoisonError::into_inner);
        wakes.push(Arc::clone(&wake));
        wake
    }

    /// Tells tasks who is there and who decides.
    pub(super) fn set_team(&self, view: TeamView) {
        let mut team = self.team();
        if *team == view {
            return;
        }
        *team = view;
        drop(team);
        let wakes = self.wakes.lock().unwrap_or_else(PoisonError::into_inner);
        wakes.iter().for_each(|wake| wake.wake());
    }

    pub(super) fn now(&self) -> Duration {
        self.environment.clock.now()
    }

    pub(super) fn record(&self, robot: &str, change: &'static str, message: String) {
        self.environment.events.record(
            self.environment.clock.now_ns(),
            Event::Robot {
                robot: robot.to_owned(),
                change,
                message,
            },
        );
    }
}
