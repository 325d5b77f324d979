//! What was observed and waits for the fault manager: one bounded queue for everybody.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crossbeam::queue::ArrayQueue;
use fault_manager::Observation;

/// Observations that may wait. A detector that complains about every datum makes a few hundred a
/// second, and whoever reports also sees to it that the queue is emptied; this many wait only if a
/// component writes thousands of bad data in one callback.
const QUEUE: usize = 4096;

/// The last part of the queue is kept for what comes once: a component that stopped running, the
/// end of an action. Symptoms of a component that still runs come again.
const RESERVED: usize = QUEUE / 4;

/// The queue.
#[derive(Debug)]
pub struct Observations {
    queue: ArrayQueue<Observation>,
    pending: AtomicBool,
    dropped: AtomicU64,
    /// What will only be known at a later time of a simulated clock, in nanoseconds.
    later: Mutex<Vec<(u64, Observation)>>,
}

impl Default for Observations {
    fn default() -> Self {
        Self {
            queue: ArrayQueue::new(QUEUE),
            pending: AtomicBool::new(false),
            dropped: AtomicU64::new(0),
            later: Mutex::default(),
        }
    }
}

impl Observations {
    /// Leaves an observation for the fault manager. Never waits.
    pub fn report(&self, observation: Observation) {
        let comes_again = match &observation {
            Observation::Symptom(symptom) => symptom.runs,
            Observation::Passed(_) | Observation::Tick => true,
            _ => false,
        };
        let full = comes_again && self.queue.len() >= QUEUE - RESERVED;
        if full || self.queue.push(observation).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
        self.pending.store(true, Ordering::Release);
    }

    /// Leaves an observation that can only be made at a later time of a simulated clock.
    pub fn report_at(&self, time_ns: u64, observation: Observation) {
        self.later().push((time_ns, observation));
    }

    /// When the first of those can be made.
    pub fn due_ns(&self) -> Option<u64> {
        self.later().iter().map(|(time_ns, _)| *time_ns).min()
    }

    /// Makes those whose time has come and that still `hold`.
    pub fn mature(&self, now_ns: u64, holds: impl Fn(&Observation) -> bool) {
        let mut later = self.later();
        let (due, rest) = later.drain(..).partition(|(time_ns, _)| *time_ns <= now_ns);
        *later = rest;
        drop(later);
        let due: Vec<(u64, Observation)> = due;
        for (_, observation) in due {
            if holds(&observation) {
                self.report(observation);
            }
        }
    }

    fn later(&self) -> MutexGuard<'_, Vec<(u64, Observation)>> {
        self.later.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether there is something to take.
    #[inline]
    pub fn is_pending(&self) -> bool {
        self.pending.load(Ordering::Relaxed)
    }

    /// Takes the oldest one.
    pub fn take(&self) -> Option<Observation> {
        let taken = self.queue.pop();
        if taken.is_none() {
            self.pending.store(false, Ordering::Release);
            // Somebody may have come in between.
            if !self.queue.is_empty() {
                self.pending.store(true, Ordering::Release);
            }
        }
        taken
    }

    /// Symptoms that were dropped because the queue was full.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }
}
