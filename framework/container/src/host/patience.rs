//! How long the container waits for a host: as the watchdog does for a component behind the guard,
//! time counts in which the host ran or slept, not that in which it waited for a processor, nor
//! that in which the container answered it.

use std::time::{Duration, Instant};

/// How often a wait looks up: whether somebody is in a hurry, and whether the host waits for a
/// processor. Half of the shortest period of monitors.
const LOOK: Duration = Duration::from_millis(2);

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
    /// How long the thread had waited for a processor when it was first looked at.
    queued_before: Option<Duration>,
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
            queued_before: None,
        }
    }

    /// How long to wait before the next look. `hurry`: a limit for as long as somebody waits for
    /// the executor; zero if nobody does.
    pub(super) fn next_look(&self, hurry: Duration) -> Duration {
        match self.limit(hurry) {
            None => LOOK,
            Some(limit) => {
                let left = limit.saturating_sub(self.passed());
                // Once in the middle, so that what the thread had waited before is known.
                let half = if self.queued_before.is_none() {
                    left / 2
                } else {
                    left
                };
                half.clamp(Duration::from_micros(50), LOOK)
            }
        }
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

    /// Whether the limit has passed, if all time counts.
    pub(super) fn is_used_up(&self, hurry: Duration) -> bool {
        self.limit(hurry)
            .is_some_and(|limit| self.passed() >= limit)
    }

    /// The limit that was exceeded, if one was.
    pub(super) fn exceeded(&mut self, hurry: Duration) -> Option<Duration> {
        let queued = queued(self.thread).unwrap_or_default();
        let before = *self.queued_before.get_or_insert(queued);
        let limit = self.limit(hurry)?;
        let waited = queued.saturating_sub(before);
        (self.passed().saturating_sub(waited) >= limit).then_some(limit)
    }

    fn limit(&self, hurry: Duration) -> Option<Duration> {
        let limits = [self.limit, hurry].into_iter();
        limits.filter(|limit| !limit.is_zero()).min()
    }

    fn passed(&self) -> Duration {
        self.began.elapsed().saturating_sub(self.excused)
    }
}

/// How long a thread has waited for a processor since it began.
fn queued(thread: i32) -> Option<Duration> {
    let text = std::fs::read_to_string(format!("/proc/{thread}/schedstat")).ok()?;
    let nanoseconds = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}
