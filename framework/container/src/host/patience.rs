//! How long the container waits for a host: as the watchdog does for a component behind the guard,
//! time counts in which the host ran or slept, not that in which it was ready and waited for a
//! processor, nor that in which the container answered it.

use std::time::{Duration, Instant};

/// How often a wait looks at the host and whether somebody is in a hurry. Half of the shortest
/// period of monitors.
const LOOK: Duration = Duration::from_millis(2);

/// The first look is after this part of the limit: what the thread has run before it is not known.
const FIRST_LOOK: u32 = 8;

/// A host breaks a callback off within a fraction of this, in the component's own code; what is
/// elsewhere, or does not hear, is ended with its host.
const GRACE: Duration = Duration::from_millis(10);

/// A wait is no shorter: the system cannot tell the moments apart.
const SHORTEST: Duration = Duration::from_micros(50);

/// The wait for one callback.
#[derive(Debug)]
pub(super) struct Patience {
    /// Zero: none.
    limit: Duration,
    thread: i32,
    began: Instant,
    /// Since when the container itself is at work.
    paused: Option<Instant>,
    /// Time that does not count.
    excused: Duration,
    account: Account,
    /// Since when the host is breaking the callback off.
    grace: Option<Instant>,
}

/// What of the time that has passed was spent by the thread.
#[derive(Debug, Default)]
struct Account {
    spent: Duration,
    /// How much time had passed, and how much the thread had ever run, at the last look.
    last: Option<(Duration, Duration)>,
}

impl Patience {
    /// A wait that begins now, for this thread of a host.
    pub(super) fn new(limit: Duration, thread: i32) -> Self {
        Self {
            limit,
            thread,
            began: Instant::now(),
            paused: None,
            excused: Duration::ZERO,
            account: Account::default(),
            grace: None,
        }
    }

    /// How long to wait before the next look. `hurry`: a limit for as long as somebody waits for
    /// the executor; zero if nobody does.
    pub(super) fn next_look(&self, hurry: Duration) -> Duration {
        let Some(limit) = self.limit(hurry) else {
            return LOOK;
        };
        if self.grace.is_some() {
            return LOOK;
        }
        let left = match self.account.last {
            None => limit / FIRST_LOOK,
            Some(_) => limit.saturating_sub(self.account.spent),
        };
        left.clamp(SHORTEST, LOOK)
    }

    /// The container is at work for the component.
    pub(super) fn pause(&mut self) {
        self.paused = Some(Instant::now());
    }

    /// It is the component's turn again.
    pub(super) fn resume(&mut self) {
        if let Some(paused) = self.paused.take() {
            self.excused += paused.elapsed();
        }
    }

    /// Whether the limit has passed, if all time counts: then it is time for a look.
    pub(super) fn is_used_up(&self, hurry: Duration) -> bool {
        self.limit(hurry)
            .is_some_and(|limit| self.passed() >= limit)
    }

    /// Looks at the host; whether the callback is to be broken off now.
    pub(super) fn exceeded(&mut self, hurry: Duration) -> bool {
        let passed = self.passed();
        let (ran, is_ready) = observe(self.thread);
        self.account.look(passed, ran, is_ready);
        let limit = self.limit(hurry);
        self.grace.is_none() && limit.is_some_and(|limit| self.account.spent >= limit)
    }

    /// The host breaks the callback off from now on.
    pub(super) fn give_grace(&mut self) {
        self.grace = Some(Instant::now());
    }

    /// Whether the host has not managed that.
    pub(super) fn has_given_up(&self) -> bool {
        self.grace.is_some_and(|since| since.elapsed() >= GRACE)
    }

    fn limit(&self, hurry: Duration) -> Option<Duration> {
        let limits = [self.limit, hurry].into_iter();
        limits.filter(|limit| !limit.is_zero()).min()
    }

    fn passed(&self) -> Duration {
        self.began.elapsed().saturating_sub(self.excused)
    }
}

impl Account {
    /// The thread has run for `ran` since it began, and runs or waits for a processor now, or not.
    fn look(&mut self, passed: Duration, ran: Duration, is_ready: bool) {
        let (passed_before, ran_before) = match self.last {
            Some(last) => last,
            // It may have run, or waited for a processor: nobody knows.
            None if is_ready => (passed, ran),
            None => (Duration::ZERO, ran),
        };
        self.last = Some((passed, ran));
        let passed = passed.saturating_sub(passed_before);
        let ran = ran.saturating_sub(ran_before).min(passed);
        self.spent += if ran >= passed / 2 || is_ready {
            ran
        } else {
            passed
        };
    }
}

/// How long a thread has run since it began, and whether it runs or waits for a processor. What
/// cannot be read counts as asleep.
fn observe(thread: i32) -> (Duration, bool) {
    let read = |name: &str| std::fs::read_to_string(format!("/proc/{thread}/{name}"));
    let times = read("schedstat").unwrap_or_default();
    let ran = times.split(' ').next().and_then(|time| time.parse().ok());
    let state = read("stat").unwrap_or_default();
    let state = state.rsplit(')').next().map(str::trim_start);
    let is_ready = state.is_some_and(|state| state.starts_with('R'));
    (Duration::from_nanos(ran.unwrap_or_default()), is_ready)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_time_counts_that_the_thread_ran_or_slept() {
        let ms = Duration::from_millis;
        // Looks: time passed, time run, ready or not; what was spent after the last.
        for (looks, spent) in [
            // It runs all the time.
            (&[(2, 102, true), (4, 104, true), (6, 106, true)][..], 4),
            // It sleeps, or is stopped.
            (&[(2, 100, false), (4, 100, false)], 4),
            // It is ready all the time, and others run.
            (&[(2, 100, true), (4, 100, true), (9, 101, true)], 1),
            // It ran, then slept.
            (&[(2, 102, true), (4, 104, false), (6, 104, false)], 4),
        ] {
            let mut account = Account::default();
            for (passed, ran, is_ready) in looks {
                account.look(ms(*passed), ms(*ran), *is_ready);
            }
            assert_eq!(account.spent, ms(spent), "{looks:?}");
        }
    }

    #[test]
    fn the_own_thread_runs() {
        let thread = rustix::thread::gettid().as_raw_nonzero().get();
        assert!(observe(thread).1);
        assert_eq!(observe(0), (Duration::ZERO, false));
    }
}
