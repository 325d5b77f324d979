//! How fast the processor's counter counts, learned from the clock while the watchdog is at work.

use std::time::{Duration, Instant};

use crate::guard::ticks;

/// Before so much time has passed the ratio is too rough: all ages are zero.
const LEAST_BASE: Duration = Duration::from_millis(1);

/// The counter against the clock.
pub(super) struct TickRate {
    began: (Instant, u64),
    now_ticks: u64,
    nanoseconds_per_tick: f64,
}

impl TickRate {
    /// From now on.
    pub(super) fn begin() -> Self {
        let now_ticks = ticks();
        Self {
            began: (Instant::now(), now_ticks),
            now_ticks,
            nanoseconds_per_tick: 0.0,
        }
    }

    /// Looks at both.
    pub(super) fn learn(&mut self) {
        let (began, began_ticks) = self.began;
        self.now_ticks = ticks();
        self.nanoseconds_per_tick = ratio(began.elapsed(), self.now_ticks, began_ticks);
    }

    /// How long it is since the counter stood there, at the last look at both; zero if it did so
    /// later.
    pub(super) fn since(&self, then_ticks: u64) -> Duration {
        let ticks = self.now_ticks.saturating_sub(then_ticks);
        Duration::from_nanos((ticks as f64 * self.nanoseconds_per_tick) as u64)
    }
}

fn ratio(elapsed: Duration, now_ticks: u64, began_ticks: u64) -> f64 {
    let counted = now_ticks.saturating_sub(began_ticks);
    if elapsed < LEAST_BASE || counted == 0 {
        return 0.0;
    }
    elapsed.as_nanos() as f64 / counted as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_the_clocks() {
        let ms = Duration::from_millis;
        // What has passed, what was counted meanwhile; how much 3000 ticks are.
        for (elapsed, counted, expected_ns) in [
            (ms(1000), 1_000_000_000, 3000),
            (ms(1000), 3_000_000_000, 1000),
            // Too early, and a counter that stands still.
            (Duration::from_micros(1), 1000, 0),
            (ms(1000), 0, 0),
        ] {
            let rate = TickRate {
                began: (Instant::now(), 0),
                now_ticks: 10_000,
                nanoseconds_per_tick: ratio(elapsed, counted, 0),
            };
            let since = rate.since(7_000);
            assert_eq!(since, Duration::from_nanos(expected_ns), "{elapsed:?}");
            assert_eq!(rate.since(10_001), Duration::ZERO, "later");
        }
    }
}
