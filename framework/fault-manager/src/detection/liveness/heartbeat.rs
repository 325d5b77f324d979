//! `heartbeat`: work is completed in every period.

use std::time::Duration;

use system_model::rules::HeartbeatRule;

use crate::detection::Finding;

/// Periods without work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MissedHeartbeats {
    /// How many, one after the other.
    pub missed: u32,
    /// Length of each.
    pub period: Duration,
}

/// Counts periods in which no `onExecute` was completed.
#[derive(Debug, Clone)]
pub struct Heartbeat {
    period: Duration,
    limit: u32,
    /// End of the current period; none while nothing has been completed yet.
    period_end: Option<Duration>,
    /// What the counter was when the current period began.
    completed: u64,
    missed: u32,
}

impl Heartbeat {
    /// As the rule says. Acts from the first completed cycle on, or from [`Self::arm`].
    pub fn new(rule: &HeartbeatRule) -> Self {
        Self {
            // A period of nothing would never end.
            period: rule.period.max(Duration::from_nanos(1)),
            limit: rule.missed.max(1),
            period_end: None,
            completed: 0,
            missed: 0,
        }
    }

    /// Begins to count now, whether or not anything was completed (`armed="always"`).
    pub fn arm(&mut self, now: Duration, completed: u64) {
        self.period_end = Some(now.saturating_add(self.period));
        self.completed = completed;
        self.missed = 0;
    }

    /// Waits for the next completed cycle beyond `completed`, as after a reset.
    pub fn disarm(&mut self, completed: u64) {
        self.period_end = None;
        self.completed = completed;
        self.missed = 0;
    }

    /// Looks at the number of cycles completed up to now. At the end of a period it has passed if
    /// anything was completed in it; otherwise it is a symptom if it is the last of so many in a
    /// row. Several periods since the last look count one by one, all without work if there was
    /// none in between.
    pub fn step(&mut self, now: Duration, completed: u64) -> Option<Finding<MissedHeartbeats>> {
        let Some(period_end) = self.period_end else {
            if completed != self.completed {
                self.arm(now, completed);
            }
            return None;
        };
        let late = now.checked_sub(period_end)?;
        let periods = 1 + late.as_nanos() / self.period.as_nanos();
        let periods = u32::try_from(periods).unwrap_or(u32::MAX);
        self.period_end = Some(period_end.saturating_add(self.period.saturating_mul(periods)));
        if completed != self.completed {
            self.completed = completed;
            self.missed = 0;
            return Some(Finding::Passed);
        }
        self.missed = self.missed.saturating_add(periods);
        (self.missed >= self.limit).then_some(Finding::Violated(MissedHeartbeats {
            missed: self.missed,
            period: self.period,
        }))
    }
}

#[cfg(test)]
mod tests {
    use system_model::rules::Judgement;

    use super::*;

    fn heartbeat() -> Heartbeat {
        Heartbeat::new(&HeartbeatRule {
            period: Duration::from_millis(100),
            missed: 3,
            judgement: Judgement::default(),
        })
    }

    #[test]
    fn empty_periods_after_each_other_are_a_symptom() {
        // Time in ms, completed cycles, what is said: '.' passed, a digit so many missed.
        let steps = [
            (0, 0, ' '),
            (5000, 0, ' '),
            (5010, 1, ' '),
            (5100, 5, ' '),
            (5110, 9, '.'),
            (5210, 9, ' '),
            (5310, 9, ' '),
            (5400, 9, ' '),
            (5410, 9, '3'),
            (5450, 9, ' '),
            (5510, 9, '4'),
            (5550, 10, ' '),
            (5610, 10, '.'),
            (5710, 10, ' '),
            // Late by more than two periods: four have ended.
            (6055, 10, '4'),
            (6111, 11, '.'),
            (6010, 11, ' '),
            (7000, 12, '.'),
        ];
        let mut heartbeat = heartbeat();
        for (at_ms, completed, expected) in steps {
            let said = match heartbeat.step(Duration::from_millis(at_ms), completed) {
                None => ' ',
                Some(Finding::Passed) => '.',
                Some(Finding::Violated(found)) => char::from_digit(found.missed, 10).unwrap_or('?'),
            };
            assert_eq!(said, expected, "at {at_ms} ms");
        }
    }

    #[test]
    fn it_can_be_armed_before_any_work_and_disarmed() {
        let mut heartbeat = heartbeat();
        heartbeat.arm(Duration::ZERO, 0);
        let found = heartbeat.step(Duration::from_millis(300), 0);
        assert!(matches!(found, Some(Finding::Violated(_))), "{found:?}");
        heartbeat.disarm(0);
        assert_eq!(heartbeat.step(Duration::from_millis(900), 0), None);
        assert_eq!(heartbeat.step(Duration::from_millis(1000), 1), None);
        assert_eq!(
            heartbeat.step(Duration::from_millis(1100), 2),
            Some(Finding::Passed)
        );
    }
}
