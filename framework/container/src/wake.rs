//! Waking an executor that sleeps: one word, and a system call only if somebody sleeps on it.

use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use rustix::thread::futex;

/// Something happened that an executor should look at. One thread at a time sleeps on it.
#[derive(Debug, Default)]
pub struct Wake {
    state: AtomicU32,
}

/// Nothing to look at, and nobody sleeps.
const IDLE: u32 = 0;
/// Something to look at.
const PENDING: u32 = 1;
/// Nothing to look at, and somebody sleeps.
const ASLEEP: u32 = 2;

impl Wake {
    /// Asks the executor to run; wakes it if it sleeps.
    #[inline]
    pub fn wake(&self) {
        if self.state.load(Ordering::Relaxed) != PENDING
            && self.state.swap(PENDING, Ordering::AcqRel) == ASLEEP
        {
            let _woken = futex::wake(&self.state, futex::Flags::PRIVATE, 1);
        }
    }

    /// Whether it was asked to run since the last time; forgets it.
    pub fn take(&self) -> bool {
        self.state.swap(IDLE, Ordering::Acquire) == PENDING
    }

    /// Whether it was asked to run.
    pub fn is_pending(&self) -> bool {
        self.state.load(Ordering::Acquire) == PENDING
    }

    /// Sleeps until woken or until `limit` has passed; may also return early.
    pub fn sleep(&self, limit: Duration) {
        let falls_asleep =
            self.state
                .compare_exchange(IDLE, ASLEEP, Ordering::AcqRel, Ordering::Acquire);
        if falls_asleep == Err(PENDING) {
            return;
        }
        let limit = futex::Timespec {
            tv_sec: i64::try_from(limit.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: i64::from(limit.subsec_nanos()),
        };
        // Woken, interrupted or too late: the caller looks again in every case.
        let _look_again = futex::wait(&self.state, futex::Flags::PRIVATE, ASLEEP, Some(&limit));
        // Fails if somebody has woken it: that stays to be taken.
        let _was_woken =
            self.state
                .compare_exchange(ASLEEP, IDLE, Ordering::AcqRel, Ordering::Acquire);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_asked_before_or_while_it_sleeps_is_to_be_taken() {
        let wake = Wake::default();
        wake.sleep(Duration::ZERO);
        assert!(!wake.is_pending() && !wake.take(), "nobody asked");
        wake.wake();
        wake.wake();
        wake.sleep(Duration::from_secs(3600));
        assert!(wake.is_pending());
        assert!(wake.take() && !wake.take(), "once");
        std::thread::scope(|scope| {
            scope.spawn(|| wake.sleep(Duration::from_secs(3600)));
            while wake.state.load(Ordering::Acquire) != ASLEEP {
                std::thread::yield_now();
            }
            assert!(!wake.is_pending());
            wake.wake();
        });
        assert!(wake.take());
    }
}
