//! Whether the container lives, judged by the signs that it gives. Reads no clock.

use std::time::Duration;

use super::messages::Sign;

/// How long a running container may be silent unless told otherwise. Its fault manager looks after
/// time every 100 ms at least; ten of these looks missed are more than a busy machine explains.
pub const DEFAULT_BEAT_LIMIT: Duration = Duration::from_secs(1);

/// A shorter limit would take containers for hung that are not: they may be heard as seldom as
/// every 150 ms.
pub const LEAST_BEAT_LIMIT: Duration = Duration::from_millis(300);

/// Bringing up has limits of its own: 45 s for each of three stages, and 10 s for each library that
/// is looked at. This is where the parent stops believing in them.
pub(super) const START_LIMIT: Duration = Duration::from_secs(180);

/// The container promises to stop within 3 s, may take two more such times for components that hang,
/// and then writes summary and picture.
pub(super) const STOP_LIMIT: Duration = Duration::from_secs(20);

/// For how long the container may be silent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub(super) start: Duration,
    pub(super) beat: Duration,
    pub(super) stop: Duration,
}

/// Where the container is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    Starting,
    Running,
    Stopping,
}

/// The signs of one container.
#[derive(Debug)]
pub(super) struct Liveness {
    limits: Limits,
    phase: Phase,
    /// When it began to start or to stop, or was heard last.
    since: Duration,
}

impl Liveness {
    /// It was started `now`.
    pub(super) fn new(limits: Limits, now: Duration) -> Self {
        Self {
            limits,
            phase: Phase::Starting,
            since: now,
        }
    }

    /// It gives a sign `now`; whether it is in another phase with that.
    pub(super) fn hear(&mut self, sign: Sign, now: Duration) -> bool {
        match (self.phase, sign) {
            (Phase::Stopping, _) => false,
            (_, Sign::Stops) => self.stop(now),
            (Phase::Starting, Sign::Beat) => {
                self.phase = Phase::Running;
                self.since = now;
                true
            }
            (Phase::Running, Sign::Beat) => {
                self.since = now;
                false
            }
        }
    }

    /// It was asked to stop, or says that it does; whether that is new.
    pub(super) fn stop(&mut self, now: Duration) -> bool {
        let is_new = self.phase != Phase::Stopping;
        if is_new {
            self.phase = Phase::Stopping;
            self.since = now;
        }
        is_new
    }

    /// Where it is.
    pub(super) fn phase(&self) -> Phase {
        self.phase
    }

    /// For how long it has not been heard, or has been at it.
    pub(super) fn silence(&self, now: Duration) -> Duration {
        now.saturating_sub(self.since)
    }

    /// When it is overdue unless it is heard before.
    pub(super) fn due(&self) -> Duration {
        let limit = match self.phase {
            Phase::Starting => self.limits.start,
            Phase::Running => self.limits.beat,
            Phase::Stopping => self.limits.stop,
        };
        self.since.saturating_add(limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(number: u64) -> Duration {
        Duration::from_secs(number)
    }

    #[test]
    fn each_phase_has_its_limit() {
        let limits = Limits {
            start: seconds(100),
            beat: seconds(1),
            stop: seconds(10),
        };
        let (beat, stops) = (Sign::Beat, Sign::Stops);
        for (signs, phase, due) in [
            (&[][..], Phase::Starting, 105),
            (&[(7, beat)], Phase::Running, 8),
            (&[(7, beat), (8, beat), (9, beat)], Phase::Running, 10),
            (&[(7, beat), (8, stops)], Phase::Stopping, 18),
            // What comes after that it stops makes its end no later.
            (&[(8, stops), (9, beat), (10, stops)], Phase::Stopping, 18),
        ] {
            let mut liveness = Liveness::new(limits, seconds(5));
            for (at, sign) in signs {
                liveness.hear(*sign, seconds(*at));
            }
            assert_eq!(liveness.phase(), phase, "{signs:?}");
            assert_eq!(liveness.due(), seconds(due), "{signs:?}");
        }
    }

    #[test]
    fn only_the_first_beat_is_news() {
        let limits = Limits {
            start: seconds(9),
            beat: seconds(9),
            stop: seconds(9),
        };
        let mut liveness = Liveness::new(limits, seconds(0));
        let signs = [Sign::Beat, Sign::Beat, Sign::Stops, Sign::Stops, Sign::Beat];
        let news = signs.map(|sign| liveness.hear(sign, seconds(1)));
        assert_eq!(news, [true, false, true, false, false]);
        assert!(!liveness.stop(seconds(2)));
        assert_eq!(liveness.silence(seconds(4)), seconds(3));
    }
}
