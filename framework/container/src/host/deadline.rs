//! Deadlines of waits that the kernel ends: moments on its monotonic clock.

use std::time::Duration;

use rustix::time::{ClockId, Timespec, clock_gettime};

/// The moment `limit` from now; the end of time if that is later.
pub(super) fn after(limit: Duration) -> Timespec {
    let now = clock_gettime(ClockId::Monotonic);
    let seconds = i64::try_from(limit.as_secs()).unwrap_or(i64::MAX);
    let nanoseconds = now.tv_nsec + i64::from(limit.subsec_nanos());
    Timespec {
        tv_sec: now
            .tv_sec
            .saturating_add(seconds)
            .saturating_add(nanoseconds / 1_000_000_000),
        tv_nsec: nanoseconds % 1_000_000_000,
    }
}

/// Whether it is that late.
pub(super) fn has_passed(deadline: &Timespec) -> bool {
    let now = clock_gettime(ClockId::Monotonic);
    (now.tv_sec, now.tv_nsec) >= (deadline.tv_sec, deadline.tv_nsec)
}
