//! How often the container may be restarted.

use std::collections::VecDeque;
use std::time::Duration;

/// Restarts within [`RESTART_WINDOW`] that a container gets unless told otherwise: a fault that
/// comes back every 12 s will not go away by itself, and each restart is a standstill of the robot.
pub const DEFAULT_RESTARTS: u32 = 5;

/// Restarts that are longer ago do not count. A container comes up in a second or two, so that one
/// that crashes while it is brought up has used up its restarts well within this time.
pub const RESTART_WINDOW: Duration = Duration::from_secs(60);

/// The restarts that are left.
#[derive(Debug)]
pub(super) struct Budget {
    most: u32,
    /// When the container was restarted, oldest first; at most `most`.
    restarts: VecDeque<Duration>,
}

impl Budget {
    pub(super) fn new(most: u32) -> Self {
        Self {
            most,
            restarts: VecDeque::new(),
        }
    }

    /// Takes one restart at `now`, and says which of those that count it is; none if none is left.
    pub(super) fn take(&mut self, now: Duration) -> Option<usize> {
        while let Some(oldest) = self.restarts.front()
            && now.saturating_sub(*oldest) >= RESTART_WINDOW
        {
            self.restarts.pop_front();
        }
        if self.restarts.len() >= usize::try_from(self.most).unwrap_or(usize::MAX) {
            return None;
        }
        self.restarts.push_back(now);
        Some(self.restarts.len())
    }

    /// How many there are in all.
    pub(super) fn most(&self) -> u32 {
        self.most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn restarts_count_for_a_minute() {
        for (most, deaths_s, expected) in [
            (0, &[0][..], &[None][..]),
            (2, &[0, 1, 2], &[Some(1), Some(2), None]),
            (2, &[0, 59, 60], &[Some(1), Some(2), Some(2)]),
            (1, &[0, 59, 60, 61], &[Some(1), None, Some(1), None]),
        ] {
            let mut budget = Budget::new(most);
            let taken = deaths_s.iter().map(|at| {
                let at: &u64 = at;
                budget.take(Duration::from_secs(*at))
            });
            assert_eq!(taken.collect::<Vec<_>>(), expected, "{most} {deaths_s:?}");
        }
    }
}
