//! What the container knows of each executor.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use system_model::specification::{ExecutionKind, SchedulingPolicy};

/// Figures of one executor, readable from any thread at any time. They have one writer: its thread.
#[derive(Debug)]
pub struct ExecutorStatus {
    /// Its name: that of its first component.
    pub name: String,
    /// Kind.
    pub kind: ExecutionKind,
    /// Period; zero if it has none.
    pub period: Duration,
    /// Priority, 0 (lowest) to 99.
    pub priority: u8,
    /// Scheduling policy that was asked for.
    pub policy: SchedulingPolicy,
    /// For how long cycles lasted, from their beginning to their end, where there is a period.
    busy_ns: AtomicU64,
}

impl ExecutorStatus {
    /// An executor that has not begun.
    pub fn new(
        name: String,
        kind: ExecutionKind,
        period: Duration,
        priority: u8,
        policy: SchedulingPolicy,
    ) -> Self {
        Self {
            name,
            kind,
            period,
            priority,
            policy,
            busy_ns: AtomicU64::new(0),
        }
    }

    /// For how long its cycles have lasted so far, in nanoseconds of the container's clock; 0 where
    /// it has no period.
    pub fn busy_ns(&self) -> u64 {
        self.busy_ns.load(Ordering::Relaxed)
    }

    pub(crate) fn add_busy_ns(&self, time_ns: u64) {
        let busy_ns = self.busy_ns.load(Ordering::Relaxed);
        self.busy_ns.store(busy_ns + time_ns, Ordering::Relaxed);
    }

    /// The word of profiles for its kind.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            ExecutionKind::Passive => "passive",
            ExecutionKind::Periodic => "periodic",
            ExecutionKind::PeriodicShared => "periodic-shared",
            ExecutionKind::Aperiodic => "aperiodic",
        }
    }

    /// The system's name for its policy.
    pub fn policy_name(&self) -> &'static str {
        match self.policy {
            SchedulingPolicy::Other => "SCHED_OTHER",
            SchedulingPolicy::Fifo => "SCHED_FIFO",
            SchedulingPolicy::RoundRobin => "SCHED_RR",
        }
    }
}
