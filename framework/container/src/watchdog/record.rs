//! What the watchdog remembers of one lane: how long each callback that it is in has taken.

use std::time::Duration;

use crate::guard::CallLimit;
use crate::guard::loss::DEEPEST_CALL_CHAIN;
use crate::guard::watch::Inside;

/// What is to be done about a lane.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It is in no callback that is watched.
    InNothing,
    /// Its callback may become overdue after this time.
    LookWithin(Duration),
    /// Its callback is overdue.
    Overdue,
}

/// One for each depth of service calls: the time in a callee is not its caller's.
#[derive(Default)]
pub(super) struct Record {
    sightings: [Sighting; DEEPEST_CALL_CHAIN + 1],
    /// Generation of the callback that was seen last; none if the lane was in nothing.
    last: Option<u32>,
}

#[derive(Default, Clone, Copy)]
struct Sighting {
    generation: u32,
    spent: Duration,
}

impl Record {
    /// Looks at what the lane is in, since `age`, `passed` after the last look. `spent` tells how
    /// much of a time that ends now the callback has used up.
    pub(super) fn look(
        &mut self,
        inside: Inside,
        age: Duration,
        passed: Duration,
        spent: impl FnOnce(Duration) -> Duration,
    ) -> Verdict {
        let last = self.last.take();
        if inside.depth == 0 || inside.limit == CallLimit::NONE {
            return Verdict::InNothing;
        }
        self.last = Some(inside.generation);
        let Some(sighting) = self.sightings.get_mut(inside.depth) else {
            return Verdict::InNothing;
        };
        if sighting.generation != inside.generation {
            *sighting = Sighting {
                generation: inside.generation,
                spent: Duration::ZERO,
            };
        }
        // What it came from since the last look is not its own.
        sighting.spent += match last == Some(inside.generation) {
            true => spent(passed),
            false => spent(age.min(passed)),
        };
        match inside.limit.duration().checked_sub(sighting.spent) {
            Some(left) if !left.is_zero() => Verdict::LookWithin(left),
            _ => Verdict::Overdue,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    /// Generation, depth, limit and age in ms, time since the last look in ms; what follows: in ms
    /// when to look again, 0 if overdue, `None` if nothing is watched.
    type Look = (u32, usize, u32, u32, u32, Option<u32>);

    fn check(looks: &[Look]) {
        let mut record = Record::default();
        for (number, &(generation, depth, limit, age, passed, expected)) in looks.iter().enumerate()
        {
            let inside = Inside {
                generation,
                depth,
                limit: CallLimit::from(limit * MS),
            };
            let verdict = record.look(inside, age * MS, passed * MS, |all| all);
            let expected = match expected {
                None => Verdict::InNothing,
                Some(0) => Verdict::Overdue,
                Some(left) => Verdict::LookWithin(left * MS),
            };
            assert_eq!(verdict, expected, "look {number} of {looks:?}");
        }
    }

    #[test]
    fn a_callback_is_overdue_after_its_limit_and_stays_so() {
        check(&[
            (1, 1, 30, 0, 4, Some(30)),
            (1, 1, 30, 20, 20, Some(10)),
            (1, 1, 30, 30, 10, Some(0)),
            (1, 1, 30, 30, 0, Some(0)),
        ]);
    }

    #[test]
    fn time_counts_from_when_it_began_not_from_when_it_was_seen() {
        check(&[
            (1, 1, 3, 1, 4, Some(2)),
            (1, 1, 3, 3, 2, Some(0)),
            (2, 1, 3, 2, 4, Some(1)),
            // No longer than since the last look: then another one was there.
            (3, 1, 3, 9, 2, Some(1)),
        ]);
    }

    #[test]
    fn another_callback_begins_anew() {
        check(&[
            (1, 1, 30, 0, 0, Some(30)),
            (1, 1, 30, 29, 29, Some(1)),
            (2, 1, 30, 0, 29, Some(30)),
            (2, 0, 30, 0, 29, None),
            (3, 1, 30, 0, 29, Some(30)),
        ]);
    }

    #[test]
    fn time_in_a_callee_is_the_callees() {
        check(&[
            (1, 1, 30, 0, 0, Some(30)),
            (1, 1, 30, 20, 20, Some(10)),
            (2, 2, 50, 0, 5, Some(50)),
            (2, 2, 50, 49, 49, Some(1)),
            // Back in the caller: what was the callee's meanwhile is not its own.
            (1, 1, 30, 2, 9, Some(8)),
            (1, 1, 30, 7, 7, Some(1)),
            (1, 1, 30, 8, 1, Some(0)),
        ]);
    }

    #[test]
    fn the_container_answering_does_not_count() {
        check(&[
            (1, 1, 30, 0, 0, Some(30)),
            (1, 1, 0, 0, 1000, None),
            (1, 1, 30, 4, 100, Some(26)),
        ]);
    }

    #[test]
    fn what_is_not_limited_is_not_watched() {
        check(&[(1, 1, 0, 0, 0, None), (1, 1, 0, 0, 100_000, None)]);
    }
}
