//! How busy the processors were, by `/proc/stat`.

use std::io;

/// Time of all processors since the machine was started, in ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProcessorTime {
    all: u64,
    idle: u64,
}

impl ProcessorTime {
    /// Until now.
    ///
    /// # Errors
    /// If `/proc/stat` cannot be read or is not as expected.
    pub fn now() -> io::Result<Self> {
        let text = std::fs::read_to_string("/proc/stat")?;
        Self::read(&text).ok_or_else(|| io::Error::other("/proc/stat has no line 'cpu'"))
    }

    /// Percentage of the time between the two in which the processors were not idle.
    pub fn busy_percent_since(self, earlier: Self) -> f64 {
        let all = self.all.saturating_sub(earlier.all);
        let idle = self.idle.saturating_sub(earlier.idle).min(all);
        if all == 0 {
            return 0.0;
        }
        #[allow(clippy::cast_precision_loss)] // ticks of years
        let share = (all - idle) as f64 / all as f64;
        100.0 * share
    }

    /// The first line: `cpu user nice system idle iowait irq softirq steal guest guest_nice`; time
    /// of guests is in that of users already.
    fn read(text: &str) -> Option<Self> {
        const COUNTED: usize = 8;
        const IDLE: [usize; 2] = [3, 4];
        let line = text.lines().find(|line| line.starts_with("cpu "))?;
        let ticks = line.split_whitespace().skip(1).take(COUNTED);
        let ticks: Vec<u64> = ticks.map(|it| it.parse().ok()).collect::<Option<_>>()?;
        let idle = IDLE.map(|index| ticks.get(index).copied());
        Some(Self {
            all: ticks.iter().sum(),
            idle: idle[0]? + idle[1]?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_is_not_busy_and_guests_are_not_counted_twice() {
        let read = |text| ProcessorTime::read(text).expect("a line");
        let earlier = read("cpu  100 0 100 700 100 0 0 0 50 0\ncpu0 1 2 3 4 5 6 7 8 9 10\n");
        assert_eq!(
            (earlier.all, earlier.idle),
            (1000, 800),
            "user, system; idle and waiting"
        );
        let later = read("cpu  120 10 130 720 100 10 5 5 60 0\n");
        assert!((later.busy_percent_since(earlier) - 80.0).abs() < 1e-9);
        assert!(later.busy_percent_since(later).abs() < 1e-9);
        for wrong in [
            "",
            "cpu  1 2 x 4 5 6 7 8\n",
            "cpu 1 2 3\n",
            "cpu0 1 2 3 4\n",
        ] {
            assert_eq!(ProcessorTime::read(wrong), None, "{wrong:?}");
        }
    }
}
