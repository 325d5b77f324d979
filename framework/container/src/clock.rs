//! Two clocks behind one face: the machine's, and one that the simulated schedule sets.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time since the application started.
#[derive(Debug)]
pub enum Clock {
    /// The machine's monotonic clock.
    Real(Instant),
    /// Set by the schedule, in nanoseconds.
    Simulated(AtomicU64),
}

impl Clock {
    /// A real clock that starts now.
    pub fn real() -> Self {
        Self::real_since(Duration::ZERO)
    }

    /// A real clock that started so long ago.
    pub fn real_since(ago: Duration) -> Self {
        let now = Instant::now();
        Self::Real(now.checked_sub(ago).unwrap_or(now))
    }

    /// A simulated clock at zero.
    pub fn simulated() -> Self {
        Self::Simulated(AtomicU64::new(0))
    }

    /// Whether time goes as the schedule says.
    pub fn is_simulated(&self) -> bool {
        matches!(self, Self::Simulated(_))
    }

    /// Nanoseconds since the application started.
    pub fn now_ns(&self) -> u64 {
        match self {
            Self::Real(start) => u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX),
            // Whoever sees a time also sees what was done before time came so far.
            Self::Simulated(now) => now.load(Ordering::Acquire),
        }
    }

    /// The time at an instant of the machine's clock; none where time is simulated.
    pub fn at_ns(&self, instant: Instant) -> Option<u64> {
        match self {
            Self::Real(start) => Some(nanoseconds(instant.saturating_duration_since(*start))),
            Self::Simulated(_) => None,
        }
    }

    /// What a cycle that began at `cycle_ns` takes for now: reading the machine's clock for every
    /// datum would cost more than the datum does.
    pub fn cycle_time_ns(&self, cycle_ns: u64) -> u64 {
        match self {
            Self::Real(_) => cycle_ns,
            Self::Simulated(_) => self.now_ns(),
        }
    }

    /// Time since the application started.
    pub fn now(&self) -> Duration {
        Duration::from_nanos(self.now_ns())
    }

    /// Sets simulated time; does nothing to a real clock. Time never goes back.
    pub fn advance_to(&self, now_ns: u64) {
        if let Self::Simulated(now) = self {
            now.fetch_max(now_ns, Ordering::Release);
        }
    }
}

/// A duration in nanoseconds; 584 years are enough.
pub(crate) fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
