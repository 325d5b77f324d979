//! Waking an executor that sleeps: one flag, one system call, and only if it was not set already.

use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use rustix::thread::futex;

/// Something happened that an executor should look at.
#[derive(Debug, Default)]
pub struct Wake {
    pending: AtomicU32,
}

impl Wake {
    /// Asks the executor to run; wakes it if it sleeps.
    #[inline]
    pub fn wake(&self) {
        if self.pending.load(Ordering::Relaxed) == 0 && self.pending.swap(1, Ordering::Release) == 0
        {
            let _woken = futex::wake(&self.pending, futex::Flags::PRIVATE, 1);
        }
    }

    /// Whether it was asked to run since the last time; forgets it.
    pub fn take(&self) -> bool {
        self.pending.swap(0, Ordering::Acquire) != 0
    }

    /// Whether it was asked to run.
    pub fn is_pending(&self) -> bool {
        self.pending.load(Ordering::Acquire) != 0
    }

    /// Sleeps until woken or until `limit` has passed; may also return early.
    pub fn sleep(&self, limit: Duration) {
        let limit = futex::Timespec {
            tv_sec: i64::try_from(limit.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: i64::from(limit.subsec_nanos()),
        };
        // Woken, interrupted or too late: the caller looks again in every case.
        let _look_again = futex::wait(&self.pending, futex::Flags::PRIVATE, 0, Some(&limit));
    }
}
