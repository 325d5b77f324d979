//! Components that cannot be brought back: the fault manager asks that their task go on without them.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use fault_manager::ActionId;
use serde::Serialize;

/// Requests that may wait. Each is of another component, and a task has no more than 200.
const MOST_REQUESTS: usize = 256;

/// What waits for the adaptations of a container.
#[derive(Debug, Default)]
pub struct AdaptationRequests {
    /// Components of watched tasks.
    watched: Mutex<Vec<usize>>,
    waiting: Mutex<Vec<(usize, ActionId)>>,
    /// Decisions so far, and changes among them.
    decided: AtomicU64,
    changed: AtomicU64,
}

/// What self-adaptation has come to in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct AdaptationSummary {
    /// Decisions.
    pub decisions: u64,
    /// Those after which the task was done in another way.
    pub changes: u64,
}

impl AdaptationRequests {
    /// Requests for these components will be taken.
    pub fn watch(&self, components: impl IntoIterator<Item = usize>) {
        lock(&self.watched).extend(components);
    }

    /// A decision has ended.
    pub fn count(&self, has_changed: bool) {
        self.decided.fetch_add(1, Ordering::Relaxed);
        self.changed
            .fetch_add(u64::from(has_changed), Ordering::Relaxed);
    }

    /// What it has come to; none where no task is watched over.
    pub fn summary(&self) -> Option<AdaptationSummary> {
        let is_watched = !lock(&self.watched).is_empty();
        is_watched.then(|| AdaptationSummary {
            decisions: self.decided.load(Ordering::Relaxed),
            changes: self.changed.load(Ordering::Relaxed),
        })
    }

    /// Asks that the task go on without a component; false if nobody would take it.
    pub fn ask(&self, component: usize, action: ActionId) -> bool {
        if !lock(&self.watched).contains(&component) {
            return false;
        }
        let mut waiting = lock(&self.waiting);
        let has_room = waiting.len() < MOST_REQUESTS;
        if has_room {
            waiting.push((component, action));
        }
        has_room
    }

    /// Takes the requests of some components.
    pub fn take(&self, of: impl Fn(usize) -> bool) -> Vec<(usize, ActionId)> {
        let mut waiting = lock(&self.waiting);
        let (taken, rest) = waiting.drain(..).partition(|(component, _)| of(*component));
        *waiting = rest;
        taken
    }

    /// Whether there are requests of some components.
    pub fn any(&self, of: impl Fn(usize) -> bool) -> bool {
        lock(&self.waiting)
            .iter()
            .any(|(component, _)| of(*component))
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_watched_is_asked_for_and_each_takes_its_own() {
        let requests = AdaptationRequests::default();
        assert!(!requests.ask(3, ActionId(1)));
        requests.watch([3, 7]);
        assert!(requests.ask(3, ActionId(2)) && requests.ask(7, ActionId(3)));
        assert!(requests.any(|component| component == 7));
        assert_eq!(
            requests.take(|component| component == 7),
            [(7, ActionId(3))]
        );
        assert_eq!(requests.take(|_| true), [(3, ActionId(2))]);
        assert!(!requests.any(|_| true));
    }

    #[test]
    fn no_more_wait_than_there_is_room_for() {
        let requests = AdaptationRequests::default();
        requests.watch([0]);
        let asked = (0..=MOST_REQUESTS as u64).map(|number| requests.ask(0, ActionId(number)));
        assert_eq!(asked.filter(|asked| *asked).count(), MOST_REQUESTS);
    }
}
