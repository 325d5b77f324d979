//! How often components work and how long their executors take for it, over the last second.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::{ComponentStatus, ExecutorStatus};
use crate::clock::nanoseconds;

/// Over how long figures are taken: at 10 Hz that is ten cycles, so they stand still.
const WINDOW: Duration = Duration::from_secs(1);

/// Looks that come sooner after another are left out: thirty looks are kept at most.
const LOOK_PERIOD: Duration = Duration::from_millis(50);

/// Rates and loads of all components.
#[derive(Debug)]
pub struct Meter {
    components: Vec<Arc<ComponentStatus>>,
    executors: Vec<Arc<ExecutorStatus>>,
    /// By component: index of its executor.
    executor_of: Vec<usize>,
    looks: Mutex<VecDeque<Look>>,
}

#[derive(Debug)]
struct Look {
    at_ns: u64,
    cycles: Vec<u64>,
    busy_ns: Vec<u64>,
}

/// Figures of one component.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Figures {
    /// Completed `onExecute` per second of the container's clock; none before a first second.
    pub rate_hz: Option<f64>,
    /// For how much of its period its executor is in its cycle, in percent; above 100 it runs over.
    /// None without a period.
    pub load_percent: Option<f64>,
}

impl Meter {
    /// Of these components; `executor_of` has the index of the executor of each.
    pub fn new(
        components: Vec<Arc<ComponentStatus>>,
        executors: Vec<Arc<ExecutorStatus>>,
        executor_of: Vec<usize>,
    ) -> Self {
        Self {
            components,
            executors,
            executor_of,
            looks: Mutex::default(),
        }
    }

    /// Takes all counters down, at this time of the container's clock.
    pub fn look(&self, now: Duration) {
        let now_ns = nanoseconds(now);
        let mut looks = self.looks();
        let last_ns = looks.back().map(|last| last.at_ns);
        if last_ns.is_some_and(|last_ns| now_ns < last_ns + nanoseconds(LOOK_PERIOD)) {
            return;
        }
        looks.push_back(Look {
            at_ns: now_ns,
            cycles: self.components.iter().map(|it| it.cycles()).collect(),
            busy_ns: self.executors.iter().map(|it| it.busy_ns()).collect(),
        });
        // One of those that are older is kept: the window begins with it.
        let is_old = |look: &Look| look.at_ns + nanoseconds(WINDOW) <= now_ns;
        while looks.get(1).is_some_and(is_old) {
            looks.pop_front();
        }
    }

    /// The figures of a component over the last window.
    pub fn figures(&self, component: usize) -> Figures {
        let looks = self.looks();
        let (Some(first), Some(last)) = (looks.front(), looks.back()) else {
            return Figures::default();
        };
        let passed_ns = last.at_ns - first.at_ns;
        if passed_ns < nanoseconds(LOOK_PERIOD) {
            return Figures::default();
        }
        let per_second = |now: u64, before: u64| {
            let more = Duration::from_nanos(now.saturating_sub(before)).as_secs_f64();
            more / Duration::from_nanos(passed_ns).as_secs_f64()
        };
        let cycles = first.cycles.get(component).zip(last.cycles.get(component));
        let executor = self.executor(component).filter(|it| !it.period.is_zero());
        let index = self.executor_of.get(component).copied().unwrap_or_default();
        let busy = first.busy_ns.get(index).zip(last.busy_ns.get(index));
        Figures {
            rate_hz: cycles.map(|(before, now)| per_second(*now, *before) * 1e9),
            load_percent: executor
                .and(busy)
                .map(|(before, now)| per_second(*now, *before) * 1e2),
        }
    }

    /// The executor of a component.
    pub fn executor(&self, component: usize) -> Option<&Arc<ExecutorStatus>> {
        self.executors.get(*self.executor_of.get(component)?)
    }

    fn looks(&self) -> MutexGuard<'_, VecDeque<Look>> {
        self.looks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use system_model::specification::{ExecutionKind, SchedulingPolicy};

    use super::*;

    #[test]
    fn figures_are_those_of_the_last_second() {
        let component = |name: &str| Arc::new(ComponentStatus::new(name.to_owned()));
        let executor = |period| {
            let kind = ExecutionKind::Periodic;
            let policy = SchedulingPolicy::Other;
            let period = Duration::from_millis(period);
            Arc::new(ExecutorStatus::new("e".into(), kind, period, 0, policy))
        };
        let (camera, listener) = (component("camera"), component("listener"));
        let (timed, untimed) = (executor(20), executor(0));
        let meter = Meter::new(
            vec![Arc::clone(&camera), listener],
            vec![Arc::clone(&timed), untimed],
            vec![0, 1],
        );
        let ms = Duration::from_millis;
        meter.look(ms(0));
        assert_eq!(meter.figures(0), Figures::default());
        for cycle in 1..=300 {
            // The first 200 cycles take 1 ms of 20, the others 5.
            timed.add_busy_ns(if cycle <= 200 { 1_000_000 } else { 5_000_000 });
            camera.count_cycle();
            meter.look(ms(20 * cycle));
            if cycle == 100 {
                let figures = meter.figures(0);
                assert_eq!(figures.rate_hz.map(f64::round), Some(50.0));
                assert_eq!(figures.load_percent.map(f64::round), Some(5.0));
            }
        }
        let figures = meter.figures(0);
        assert_eq!(figures.rate_hz.map(f64::round), Some(50.0));
        assert_eq!(figures.load_percent.map(f64::round), Some(25.0));
        let other = meter.figures(1);
        assert_eq!((other.rate_hz, other.load_percent), (Some(0.0), None));
        assert_eq!(meter.figures(2).load_percent, None);
        assert!(meter.looks().len() <= 30, "looks are few");
    }
}
