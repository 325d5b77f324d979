//! What time brings: orders that are due, deadlines of the fault manager, looks of monitors,
//! injected faults.

use std::sync::PoisonError;
use std::sync::atomic::Ordering;
use std::time::Duration;

use fault_manager::Observation;

use super::LOOK_PERIOD;
use super::supervisor::Supervisor;
use crate::clock::nanoseconds;
use crate::recording::Recorder;

impl Supervisor {
    /// What time brings: orders that are due, deadlines of the fault manager.
    pub fn tick(&self) {
        let now_ns = self.environment.clock.now_ns();
        self.environment
            .observations
            .mature(now_ns, |observation| self.is_of_now(observation));
        self.inject(now_ns);
        self.monitors
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .look(Duration::from_nanos(now_ns), &self.environment.observations);
        self.record_backtraces();
        let (due, wants_tick) = {
            let mut core = self.lock();
            self.write_records(&mut core);
            let mut due = Vec::new();
            core.later.retain(|(time_ns, order)| {
                let is_due = *time_ns <= now_ns;
                if is_due {
                    due.push(order.clone());
                }
                !is_due
            });
            let wants_tick = core
                .manager
                .due()
                .is_some_and(|due| nanoseconds(due) <= now_ns);
            (due, wants_tick)
        };
        for order in due {
            self.give(order);
        }
        if wants_tick {
            self.environment.observations.report(Observation::Tick);
        }
        self.attend();
    }

    /// Lets the figures of all process models be recorded.
    pub fn record_models(&self, recorder: &mut Recorder) {
        let mut monitors = self.monitors.lock().unwrap_or_else(PoisonError::into_inner);
        for model in &mut monitors.models {
            let (component, name, data_type) = model.recorded();
            if let Some(port) = recorder.port(component, &name, "monitor", &data_type) {
                model.record_by(port);
            }
        }
    }

    /// When the next tick is due, in nanoseconds of the container's clock.
    pub fn due_ns(&self) -> Option<u64> {
        let decisions = self.lock().due_ns();
        let monitors = self
            .monitors
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .due_ns();
        let observations = self.environment.observations.due_ns();
        let injections = self.environment.injections.is_armed().then(|| {
            let period_ns = nanoseconds(LOOK_PERIOD);
            (self.injected_ns.load(Ordering::Relaxed) / period_ns + 1) * period_ns
        });
        [decisions, monitors, observations, injections]
            .into_iter()
            .flatten()
            .min()
    }

    /// Sleeps until something may be due, at most `limit`. Whoever makes something due earlier
    /// wakes it, and nobody else: that may be an executor in a hurry.
    pub fn sleep_until_due(&self, limit: Duration) {
        // Said first: what becomes due while this thread looks must wake it.
        self.looks_again_ns.store(u64::MAX, Ordering::SeqCst);
        let due_ns = self.due_ns().unwrap_or(u64::MAX);
        let now_ns = self.environment.clock.now_ns();
        let again_ns = due_ns.min(now_ns + nanoseconds(limit));
        self.looks_again_ns.store(again_ns, Ordering::SeqCst);
        self.wake
            .sleep(Duration::from_nanos(again_ns.saturating_sub(now_ns)));
        self.wake.take();
    }

    /// Makes a thread that sleeps look again.
    pub fn rouse(&self) {
        self.wake.wake();
    }

    /// Whether an observation is about an instance that is still there.
    fn is_of_now(&self, observation: &Observation) -> bool {
        let Observation::Symptom(symptom) = observation else {
            return true;
        };
        let core = self.lock();
        let detector = core.manager.detectors().get(symptom.detector.0);
        let status = detector.and_then(|detector| self.statuses.get(detector.component));
        status.is_some_and(|status| status.incarnation() == symptom.incarnation)
    }

    /// Faults that begin and end with time.
    fn inject(&self, now_ns: u64) {
        let environment = &self.environment;
        if !environment.injections.is_armed() {
            return;
        }
        self.injected_ns.store(now_ns, Ordering::Relaxed);
        let now = Duration::from_nanos(now_ns);
        let changed = environment.injections.advance(now, &environment.worlds);
        environment.record_injections(&changed);
    }
}
