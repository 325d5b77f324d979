//! `freshness`: an input has a new datum often enough.

use std::time::Duration;

use system_model::rules::FreshnessRule;

use crate::detection::Finding;

/// An input without new data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Age {
    /// Age of the newest datum.
    pub age: Duration,
    /// Largest age allowed.
    pub maximum: Duration,
}

/// Watches the age of the newest datum.
#[derive(Debug, Clone)]
pub struct Freshness {
    maximum_age: Duration,
    /// When the newest datum came, or the watch began.
    newest: Option<Duration>,
    /// Whole times [`Self::maximum_age`] without a datum that were a symptom already.
    told: u64,
}

impl Freshness {
    /// As the rule says. Acts from the first datum on, or from [`Self::arm`].
    pub fn new(rule: &FreshnessRule) -> Self {
        Self {
            // Data that may not have any age would be stale while they are read.
            maximum_age: rule.maximum_age.max(Duration::from_nanos(1)),
            newest: None,
            told: 0,
        }
    }

    /// Begins to watch now, whether or not there was a datum (`armed="always"`).
    pub fn arm(&mut self, now: Duration) {
        self.newest = Some(now);
        self.told = 0;
    }

    /// Waits for the next datum, as after its writer was stopped on purpose.
    pub fn disarm(&mut self) {
        self.newest = None;
        self.told = 0;
    }

    /// Whether the input is too old now to be read: true from the moment of the first symptom until
    /// the next datum.
    pub fn is_stale(&self, now: Duration) -> bool {
        let age = self.newest.map(|newest| now.saturating_sub(newest));
        age.is_some_and(|age| age > self.maximum_age)
    }

    /// Looks at when the newest datum came, `None` while there was none. It has passed when a new
    /// one has come; every further maximum age without one is one more symptom, however often one
    /// looks.
    pub fn step(&mut self, now: Duration, newest: Option<Duration>) -> Option<Finding<Age>> {
        if let Some(newest) = newest
            && self.newest.is_none_or(|known| newest > known)
        {
            self.newest = Some(newest);
            self.told = 0;
            if !self.is_stale(now) {
                return Some(Finding::Passed);
            }
        }
        let age = now.saturating_sub(self.newest?);
        // An age of exactly the maximum is allowed.
        let just_below = age.saturating_sub(Duration::from_nanos(1));
        let overdue = just_below.as_nanos() / self.maximum_age.as_nanos();
        let overdue = u64::try_from(overdue).unwrap_or(u64::MAX);
        if overdue <= self.told {
            return None;
        }
        self.told = overdue;
        Some(Finding::Violated(Age {
            age,
            maximum: self.maximum_age,
        }))
    }
}

#[cfg(test)]
mod tests {
    use system_model::rules::Judgement;

    use super::*;

    #[test]
    fn every_maximum_age_without_a_datum_is_a_symptom() {
        let mut freshness = Freshness::new(&FreshnessRule {
            maximum_age: Duration::from_millis(50),
            judgement: Judgement::default(),
        });
        // Time, time of the newest datum in ms; '.' passed, '!' symptom; stale.
        let steps = [
            (900, None, ' ', false),
            (1000, Some(1000), '.', false),
            (1050, Some(1000), ' ', false),
            (1051, Some(1000), '!', true),
            (1070, Some(1000), ' ', true),
            (1100, Some(1000), ' ', true),
            (1101, Some(1000), '!', true),
            (1110, Some(1105), '.', false),
            (1100, Some(1105), ' ', false),
            (1400, Some(1200), '!', true),
            (1400, Some(1400), '.', false),
            (1400, None, ' ', false),
            (1460, None, '!', true),
        ];
        for (now, newest, expected, stale) in steps {
            let now = Duration::from_millis(now);
            let said = match freshness.step(now, newest.map(Duration::from_millis)) {
                None => ' ',
                Some(Finding::Passed) => '.',
                Some(Finding::Violated(_)) => '!',
            };
            assert_eq!(
                (said, freshness.is_stale(now)),
                (expected, stale),
                "{now:?}"
            );
        }
        freshness.disarm();
        assert_eq!(freshness.step(Duration::from_secs(9), None), None);
        freshness.arm(Duration::from_secs(9));
        let found = freshness.step(Duration::from_secs(10), None);
        let age = Age {
            age: Duration::from_secs(1),
            maximum: Duration::from_millis(50),
        };
        assert_eq!(found, Some(Finding::Violated(age)));
    }
}
