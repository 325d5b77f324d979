//! Which sample of a model a datum is.

use std::time::Duration;

/// A model alone is no guide for longer than this, 2 s at 50 samples a second.
const LONG_GAP_SAMPLES: i128 = 100;
/// Part of a datum's deviation by which the grid follows it: slow enough for jitter, fast enough for
/// a device's clock that goes wrong by a percent.
const FOLLOW: i128 = 8;

/// The place of a datum in the grid of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sample {
    /// The first one.
    First,
    /// Nearer to the last one than half a period, or older.
    Early,
    /// So many periods after the last one, at least 1.
    After(usize),
    /// So long after the last one that it is a first one again.
    LongGap,
}

/// A grid of samples that follows the data.
#[derive(Debug, Clone)]
pub(super) struct SampleClock {
    period_ns: i128,
    /// Where the last datum should have been.
    last_ns: Option<i128>,
}

impl SampleClock {
    pub(super) fn new(period: Duration) -> Self {
        Self {
            period_ns: nanoseconds(period).max(1),
            last_ns: None,
        }
    }

    pub(super) fn reset(&mut self) {
        self.last_ns = None;
    }

    pub(super) fn tick(&mut self, at: Duration) -> Sample {
        let at_ns = nanoseconds(at);
        let Some(last_ns) = self.last_ns else {
            self.last_ns = Some(at_ns);
            return Sample::First;
        };
        let periods = (at_ns - last_ns + self.period_ns / 2).div_euclid(self.period_ns);
        // Time that runs back by more than a gap has begun anew.
        if !(-LONG_GAP_SAMPLES..=LONG_GAP_SAMPLES).contains(&periods) {
            self.last_ns = Some(at_ns);
            return Sample::LongGap;
        }
        if periods < 1 {
            return Sample::Early;
        }
        let expected_ns = last_ns + periods * self.period_ns;
        self.last_ns = Some(expected_ns + (at_ns - expected_ns) / FOLLOW);
        Sample::After(periods as usize)
    }
}

fn nanoseconds(time: Duration) -> i128 {
    // At most 2^64 s in ns: 2^94.
    time.as_nanos() as i128
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_find_their_place_in_the_grid() {
        use Sample::{After, Early, First, LongGap};
        let times = [
            (1000, First),
            (1000, Early),
            (1009, Early),
            (1019, After(1)),
            (1042, After(1)),
            (1100, After(3)),
            (1090, Early),
            (1120, After(1)),
            (9000, LongGap),
            (9020, After(1)),
            (20, LongGap),
            (40, After(1)),
        ];
        let mut clock = SampleClock::new(Duration::from_millis(20));
        for (at_ms, expected) in times {
            assert_eq!(
                clock.tick(Duration::from_millis(at_ms)),
                expected,
                "{at_ms}"
            );
        }
        clock.reset();
        assert_eq!(clock.tick(Duration::MAX), First);
        assert_eq!(clock.tick(Duration::ZERO), LongGap);
    }

    #[test]
    fn a_clock_that_goes_wrong_is_followed() {
        let mut clock = SampleClock::new(Duration::from_millis(20));
        for sample in 0..10_000_u64 {
            // One percent slow, with jitter of a quarter of a period.
            let at_us = sample * 20_200 + (sample % 3) * 5_000;
            let found = clock.tick(Duration::from_micros(at_us));
            assert_eq!(found == Sample::After(1), sample > 0, "sample {sample}");
        }
    }
}
