//! When a standby that could not be prepared is tried again: a device may be busy for a while, a file
//! may just be replaced by a newer one.

use std::time::Duration;

/// Pauses before the second and each further attempt. What lasts longer than all of them together is
/// no passing trouble: the next takeover, or nobody, finds that out.
const PAUSES: [Duration; 3] = [
    Duration::from_millis(100),
    Duration::from_secs(1),
    Duration::from_secs(10),
];

/// Components whose standbys are to be prepared, each once.
#[derive(Debug, Default)]
pub struct Refills(Vec<Refill>);

#[derive(Debug)]
struct Refill {
    component: usize,
    /// Attempts that have failed.
    failed: usize,
    not_before: Duration,
}

impl Refills {
    /// A component has lost a standby: it is tried from the first attempt on.
    pub fn want(&mut self, component: usize, now: Duration) {
        self.0.retain(|other| other.component != component);
        self.0.push(Refill {
            component,
            failed: 0,
            not_before: now,
        });
    }

    /// The next one whose time has come.
    pub fn next(&self, now: Duration) -> Option<usize> {
        let due = self.0.iter().find(|refill| refill.not_before <= now)?;
        Some(due.component)
    }

    /// How an attempt ended; whether that was the last one, in vain.
    pub fn attempted(&mut self, component: usize, succeeded: bool, now: Duration) -> bool {
        let found = self.0.iter_mut().find(|one| one.component == component);
        let Some(refill) = found else { return false };
        let pause = PAUSES.get(refill.failed).copied();
        match pause {
            Some(pause) if !succeeded => {
                refill.failed += 1;
                refill.not_before = now + pause;
            }
            _ => self.0.retain(|other| other.component != component),
        }
        !succeeded && pause.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_attempt_that_fails_is_repeated_with_longer_pauses_and_given_up() {
        let ms = Duration::from_millis;
        let mut refills = Refills::default();
        refills.want(7, ms(0));
        // When it is tried, and whether that was the last time.
        for (at, next, given_up) in [
            (0, 100, false),
            (100, 1_100, false),
            (1_200, 11_200, false),
            (12_000, u64::MAX, true),
        ] {
            assert_eq!(refills.next(ms(at)), Some(7), "at {at}");
            assert_eq!(refills.attempted(7, false, ms(at)), given_up, "at {at}");
            assert_eq!(refills.next(ms(next.saturating_sub(1))), None, "after {at}");
        }
    }

    #[test]
    fn one_that_is_there_is_done_and_a_new_wish_begins_anew() {
        let ms = Duration::from_millis;
        let mut refills = Refills::default();
        refills.want(1, ms(0));
        refills.want(2, ms(0));
        assert!(!refills.attempted(1, true, ms(5)));
        assert!(!refills.attempted(2, false, ms(5)));
        assert_eq!(refills.next(ms(6)), None);
        refills.want(2, ms(6));
        refills.want(2, ms(6));
        assert_eq!(refills.next(ms(6)), Some(2));
        assert!(!refills.attempted(2, true, ms(7)));
        assert_eq!(refills.next(ms(99_999)), None);
    }
}
