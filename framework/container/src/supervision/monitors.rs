//! What is looked at from time to time: age of data, completed work, overruns, memory, process
//! models.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use fault_manager::detection::Finding;
use fault_manager::detection::liveness::{Freshness, Heartbeat, Overruns};
use fault_manager::{DetectorId, Evidence, Observation, Symptom};
use system_model::fault::FaultKind;
use system_model::life_cycle::LifeCycleState;

use super::{ModelMonitor, Observations};
use crate::port::Newest;
use crate::status::ComponentStatus;

/// How often: a quarter of the shortest period of the reference robot, so that a process model adds
/// no more than that to its delay; a look at ten components takes a microsecond.
pub const LOOK_PERIOD: Duration = Duration::from_millis(5);

/// Bytes of the kilobyte of the rules.
const KILOBYTE: u64 = 1024;

/// Everything that is looked at.
#[derive(Default)]
pub struct Monitors {
    /// Ages of inputs.
    pub inputs: Vec<InputAge>,
    /// Completed work.
    pub heartbeats: Vec<WorkDone>,
    /// Overruns.
    pub overruns: Vec<OverrunCount>,
    /// Memory.
    pub memories: Vec<MemoryUse>,
    /// Process models.
    pub models: Vec<ModelMonitor>,
    due_ns: u64,
}

/// Whom a finding is charged to.
pub struct Subject {
    detector: DetectorId,
    status: Arc<ComponentStatus>,
    complaining: bool,
    /// The incarnation that was looked at last.
    incarnation: u32,
}

/// The age of the newest datum of an input.
pub struct InputAge {
    /// Who reads it.
    pub subject: Subject,
    /// The port.
    pub port: String,
    /// The watch.
    pub freshness: Freshness,
    /// When the newest datum was written.
    pub newest: Arc<Newest>,
}

/// A heartbeat.
pub struct WorkDone {
    /// Who works.
    pub subject: Subject,
    /// The watch.
    pub heartbeat: Heartbeat,
}

/// Overruns of one component's executor.
pub struct OverrunCount {
    /// Who runs over.
    pub subject: Subject,
    /// The watch.
    pub overruns: Overruns,
}

/// Memory that a component's callbacks have allocated and not freed.
pub struct MemoryUse {
    /// Who uses it.
    pub subject: Subject,
    /// So much is allowed, in bytes.
    pub limit_bytes: u64,
}

impl Subject {
    /// Findings of this detector, about this component.
    pub fn new(detector: DetectorId, status: Arc<ComponentStatus>) -> Self {
        Self {
            detector,
            complaining: false,
            incarnation: status.incarnation(),
            status,
        }
    }

    /// Whether the component runs, and is the one that was looked at last.
    fn goes_on(&mut self, now: Duration) -> bool {
        let incarnation = self.status.incarnation();
        let same = incarnation == self.incarnation;
        self.incarnation = incarnation;
        let now_ns = crate::clock::nanoseconds(now);
        same && (self.status.state() == LifeCycleState::Active || self.status.hangs_at(now_ns))
    }

    fn report(
        &mut self,
        finding: Option<Finding<(FaultKind, Evidence)>>,
        now: Duration,
        observations: &Observations,
    ) {
        match finding {
            Some(Finding::Violated((kind, evidence))) => {
                self.complaining = true;
                observations.report(Observation::Symptom(Box::new(Symptom {
                    detector: self.detector,
                    incarnation: self.incarnation,
                    kind,
                    return_code: 0,
                    at: now,
                    runs: true,
                    evidence,
                })));
            }
            Some(Finding::Passed) if self.complaining => {
                self.complaining = false;
                observations.report(Observation::Passed(self.detector));
            }
            Some(Finding::Passed) | None => {}
        }
    }
}

impl Monitors {
    /// When to look next, in nanoseconds of the container's clock; none if there is nothing to look
    /// at.
    pub fn due_ns(&self) -> Option<u64> {
        let nothing = self.inputs.is_empty()
            && self.heartbeats.is_empty()
            && self.overruns.is_empty()
            && self.memories.is_empty()
            && self.models.is_empty();
        (!nothing).then_some(self.due_ns)
    }

    /// Looks at everything, if it is time.
    pub fn look(&mut self, now: Duration, observations: &Observations) {
        let now_ns = crate::clock::nanoseconds(now);
        if now_ns < self.due_ns {
            return;
        }
        let period_ns = crate::clock::nanoseconds(LOOK_PERIOD);
        // On the grid of the period: in simulated time every run looks at the same moments.
        self.due_ns = (now_ns / period_ns + 1) * period_ns;
        for input in &mut self.inputs {
            input.look(now, observations);
        }
        for work in &mut self.heartbeats {
            work.look(now, observations);
        }
        for overruns in &mut self.overruns {
            overruns.look(now, observations);
        }
        for memory in &mut self.memories {
            memory.look(now, observations);
        }
        for model in &mut self.models {
            model.poll(observations);
        }
    }
}

impl InputAge {
    fn look(&mut self, now: Duration, observations: &Observations) {
        if !self.subject.goes_on(now) {
            self.freshness.disarm();
            return;
        }
        let newest = self.newest.load(Ordering::Relaxed);
        let newest = (newest > 0).then(|| Duration::from_nanos(newest));
        let finding = self
            .freshness
            .step(now, newest)
            .map(|finding| match finding {
                Finding::Passed => Finding::Passed,
                Finding::Violated(age) => Finding::Violated((
                    FaultKind::Stale,
                    Evidence::Age {
                        port: self.port.clone(),
                        age_ms: milliseconds(age.age),
                        maximum_ms: milliseconds(age.maximum),
                    },
                )),
            });
        self.subject.report(finding, now, observations);
    }
}

impl WorkDone {
    fn look(&mut self, now: Duration, observations: &Observations) {
        let completed = self.subject.status.cycles();
        if !self.subject.goes_on(now) {
            self.heartbeat.disarm(completed);
            return;
        }
        let finding = self
            .heartbeat
            .step(now, completed)
            .map(|finding| match finding {
                Finding::Passed => Finding::Passed,
                Finding::Violated(missed) => Finding::Violated((
                    FaultKind::HeartbeatMissed,
                    Evidence::Heartbeat {
                        missed: missed.missed,
                        period_ms: milliseconds(missed.period),
                    },
                )),
            });
        self.subject.report(finding, now, observations);
    }
}

impl OverrunCount {
    fn look(&mut self, now: Duration, observations: &Observations) {
        if !self.subject.goes_on(now) {
            return;
        }
        let overruns = self.subject.status.overruns();
        let finding = self
            .overruns
            .step(now, overruns)
            .map(|finding| match finding {
                Finding::Passed => Finding::Passed,
                Finding::Violated(count) => Finding::Violated((
                    FaultKind::Overrun,
                    Evidence::Overruns {
                        count: count.count,
                        tolerated: count.tolerated,
                        within_ms: milliseconds(count.within),
                    },
                )),
            });
        self.subject.report(finding, now, observations);
    }
}

impl MemoryUse {
    fn look(&mut self, now: Duration, observations: &Observations) {
        if !self.subject.goes_on(now) {
            return;
        }
        let used_bytes = self.subject.status.allocated_bytes();
        let finding = if used_bytes > self.limit_bytes {
            Finding::Violated((
                FaultKind::MemoryExceeded,
                Evidence::Memory {
                    used_kb: used_bytes.div_ceil(KILOBYTE),
                    limit_kb: self.limit_bytes / KILOBYTE,
                },
            ))
        } else {
            Finding::Passed
        };
        self.subject.report(Some(finding), now, observations);
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
