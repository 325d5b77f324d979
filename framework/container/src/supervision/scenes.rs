//! Backtraces of components that were taken off: found by a thread that has time, because they take
//! milliseconds of reading and parsing, and added to the verdict when they are there.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use crossbeam::queue::ArrayQueue;
use fault_manager::{Evidence, Verdict};

use crate::component::Scene;

/// Scenes that may wait: as many as a robot has components when all of them fail at once.
const WAITING: usize = 64;

/// Backtraces that are kept: those of all verdicts that are on record.
const KEPT: usize = 256;

/// Scenes on their way to backtraces.
#[derive(Debug)]
pub struct Scenes {
    waiting: ArrayQueue<Left>,
    known: Mutex<VecDeque<Known>>,
    /// Whose backtraces were found and are not on record.
    found: ArrayQueue<(String, u32)>,
}

/// A scene that a component left.
#[derive(Debug)]
struct Left {
    component: String,
    incarnation: u32,
    scene: Scene,
}

#[derive(Debug)]
struct Known {
    component: String,
    incarnation: u32,
    backtrace: Vec<String>,
}

impl Default for Scenes {
    fn default() -> Self {
        Self {
            waiting: ArrayQueue::new(WAITING),
            known: Mutex::default(),
            found: ArrayQueue::new(WAITING),
        }
    }
}

impl Scenes {
    /// Leaves a scene for the thread that has time. One too many stays without a backtrace.
    pub fn leave(&self, component: &str, incarnation: u32, scene: Scene) {
        let _without_backtrace = self.waiting.push(Left {
            component: component.to_owned(),
            incarnation,
            scene,
        });
    }

    /// Finds the backtrace of the scene that waits longest; whether there was one.
    pub(super) fn look_at_one(&self) -> bool {
        let Some(left) = self.waiting.pop() else {
            return false;
        };
        let backtrace = left.scene.backtrace();
        let mut known = self.known();
        if known.len() >= KEPT {
            known.pop_front();
        }
        known.push_back(Known {
            component: left.component.clone(),
            incarnation: left.incarnation,
            backtrace,
        });
        drop(known);
        // One too many is in no record but those that are written from now on.
        let _unrecorded = self.found.push((left.component, left.incarnation));
        true
    }

    /// Whose backtrace was found and is not on record: its component and incarnation.
    pub(super) fn take_found(&self) -> Option<(String, u32)> {
        self.found.pop()
    }

    /// Adds the backtrace to a verdict that has none, if it is known by now. Waits for nobody: what
    /// is just being added comes with the next record.
    pub(super) fn complete(&self, verdict: &mut Verdict) {
        let Evidence::Exception { backtrace, .. } = &mut verdict.evidence else {
            return;
        };
        if !backtrace.is_empty() {
            return;
        }
        let known = match self.known.try_lock() {
            Ok(known) => known,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return,
        };
        let found = known.iter().rev().find(|known| {
            (known.component.as_str(), known.incarnation)
                == (verdict.component.as_str(), verdict.incarnation)
        });
        if let Some(found) = found {
            backtrace.clone_from(&found.backtrace);
        }
    }

    fn known(&self) -> MutexGuard<'_, VecDeque<Known>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
