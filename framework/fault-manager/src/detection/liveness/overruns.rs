//! `overrun`: so many period overruns are tolerated within a time.

use std::collections::VecDeque;
use std::time::Duration;

use system_model::rules::OverrunRule;

use crate::detection::Finding;

/// Overruns nearer to each other than this part of the time are remembered as one entry, so that
/// the memory has a bound whatever the rule tolerates; they are forgotten together, at most this
/// much too early.
const PARTS: u32 = 64;

/// Cycles that took too long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverrunCount {
    /// How many within the time.
    pub count: u64,
    /// How many are tolerated.
    pub tolerated: u32,
    /// The time.
    pub within: Duration,
}

/// Counts overruns within a sliding time.
#[derive(Debug, Clone)]
pub struct Overruns {
    tolerated: u32,
    within: Duration,
    /// Time of the first of some overruns, and how many; oldest first.
    recent: VecDeque<(Duration, u64)>,
    seen: u64,
    is_violated: bool,
}

impl Overruns {
    /// As the rule says. `seen` is the counter of overruns at the beginning.
    pub fn new(rule: &OverrunRule, seen: u64) -> Self {
        Self {
            tolerated: rule.tolerated,
            within: rule.within,
            recent: VecDeque::with_capacity(PARTS as usize + 2),
            seen,
            is_violated: false,
        }
    }

    /// Looks at the number of overruns since the beginning. Each look that finds new ones while
    /// more than tolerated lie within the time is a symptom; it has passed when enough are
    /// forgotten. A counter that is smaller than before has begun anew.
    pub fn step(&mut self, now: Duration, overruns: u64) -> Option<Finding<OverrunCount>> {
        let new = overruns.checked_sub(self.seen).unwrap_or(overruns);
        self.seen = overruns;
        self.forget(now);
        if new > 0 {
            self.remember(now, new);
        }
        let count = self.count();
        let is_violated = count > u64::from(self.tolerated);
        let was_violated = std::mem::replace(&mut self.is_violated, is_violated);
        match (is_violated, was_violated) {
            (true, _) if new > 0 => Some(Finding::Violated(OverrunCount {
                count,
                tolerated: self.tolerated,
                within: self.within,
            })),
            (false, true) => Some(Finding::Passed),
            _ => None,
        }
    }

    fn count(&self) -> u64 {
        let counts = self.recent.iter().map(|(_, count)| *count);
        counts.fold(0, u64::saturating_add)
    }

    fn forget(&mut self, now: Duration) {
        while let Some((at, _)) = self.recent.front()
            && now.saturating_sub(*at) > self.within
        {
            self.recent.pop_front();
        }
    }

    fn remember(&mut self, now: Duration, new: u64) {
        match self.recent.back_mut() {
            Some((at, count)) if now.saturating_sub(*at) <= self.within / PARTS => {
                *count = count.saturating_add(new);
            }
            _ => self.recent.push_back((now, new)),
        }
    }
}

#[cfg(test)]
mod tests {
    use system_model::rules::Judgement;

    use super::*;

    fn overruns(tolerated: u32, within_ms: u64) -> Overruns {
        let rule = OverrunRule {
            tolerated,
            within: Duration::from_millis(within_ms),
            judgement: Judgement::default(),
        };
        Overruns::new(&rule, 10)
    }

    #[test]
    fn more_than_tolerated_within_the_time_are_a_symptom() {
        let mut overruns = overruns(2, 1000);
        // Time in ms, overruns so far; '.' passed, a digit so many within the time.
        let steps = [
            (0, 10, ' '),
            (100, 12, ' '),
            (200, 12, ' '),
            (600, 13, '3'),
            (700, 13, ' '),
            (1000, 14, '4'),
            (1101, 14, '.'),
            (1102, 15, '3'),
            (9000, 15, '.'),
            // The counter begins anew, with a burst.
            (9001, 5, '5'),
        ];
        for (at_ms, counter, expected) in steps {
            let said = match overruns.step(Duration::from_millis(at_ms), counter) {
                None => ' ',
                Some(Finding::Passed) => '.',
                Some(Finding::Violated(found)) => {
                    char::from_digit(found.count as u32, 10).unwrap_or('?')
                }
            };
            assert_eq!(said, expected, "at {at_ms} ms");
        }
    }

    #[test]
    fn the_memory_has_a_bound() {
        let mut overruns = overruns(1_000_000, 1000);
        let room = overruns.recent.capacity();
        for step in 0..100_000_u64 {
            let found = overruns.step(Duration::from_micros(step * 10), 10 + step);
            assert_eq!(found, None);
        }
        assert_eq!(overruns.recent.capacity(), room);
        assert!(overruns.count() > 95_000, "{}", overruns.count());
    }
}
