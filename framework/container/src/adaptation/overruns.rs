//! How often executors overrun their period, over the last second.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use crate::status::ComponentStatus;

/// Over how long it is counted, as all rates are.
const WINDOW: Duration = Duration::from_secs(1);

/// Looks that come sooner after another are left out: twenty are kept at most.
const LOOK_PERIOD: Duration = Duration::from_millis(50);

/// The counters of all components at some times.
#[derive(Debug, Default)]
pub struct Overruns {
    looks: VecDeque<(Duration, Vec<u64>)>,
}

impl Overruns {
    /// Takes all counters down.
    pub fn look(&mut self, now: Duration, statuses: &[Arc<ComponentStatus>]) {
        let last = self.looks.back().map(|(at, _)| *at);
        if last.is_some_and(|last| now < last + LOOK_PERIOD) {
            return;
        }
        let counts = statuses.iter().map(|status| status.overruns()).collect();
        self.looks.push_back((now, counts));
        // One of those that are older is kept: the window begins with it.
        while (self.looks.get(1)).is_some_and(|(at, _)| *at + WINDOW <= now) {
            self.looks.pop_front();
        }
    }

    /// Of a component; none before a second has passed.
    pub fn per_second(&self, component: usize) -> Option<f64> {
        let ((first_at, first), (last_at, last)) = (self.looks.front()?, self.looks.back()?);
        let time = last_at.checked_sub(*first_at).filter(|it| *it >= WINDOW)?;
        let count = last.get(component)?.checked_sub(*first.get(component)?)?;
        #[allow(clippy::cast_precision_loss)] // nobody counts so far
        let count = count as f64;
        Some(count / time.as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_second_counts() {
        let status = Arc::new(ComponentStatus::new("camera".into()));
        let statuses = [Arc::clone(&status)];
        let mut overruns = Overruns::default();
        for tenth in 0..=30u32 {
            overruns.look(Duration::from_millis(u64::from(tenth) * 100), &statuses);
            let expected = match tenth {
                0..10 => None,
                // One each tenth of a second until 1.5 s.
                10..=15 => Some(10.0),
                25.. => Some(0.0),
                _ => continue,
            };
            assert_eq!(overruns.per_second(0), expected, "{tenth}");
            if tenth < 15 {
                status.count_overrun();
            }
        }
    }
}
