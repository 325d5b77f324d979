//! How long callbacks may take before they count as hangs.

use std::time::Duration;

use system_model::rules::{ComponentRules, DEFAULT_PERIODLESS_DEADLINE, DEFAULT_STARTUP};
use system_model::specification::ExecutionSemantics;

use crate::clock::Clock;
use crate::guard::{CallLimit, Callback};

/// In simulated time a callback takes no time of that clock; what hangs is told by the machine's,
/// on which nothing depends there. A second is longer than a busy machine keeps an honest callback.
const SHORTEST_IN_SIMULATION: Duration = Duration::from_secs(1);

/// `onStop` and `onDestroy` close devices and let go of what they hold: they take longer than a
/// cycle, and must still fit into the time in which an application stops.
const SHORTEST_SHUTDOWN: Duration = Duration::from_secs(1);

/// How long a component's callbacks may take; zero: as long as they like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CallLimits {
    /// For the callbacks of a cycle, events and services; `onStop` and `onDestroy` get at least
    /// 1 s.
    pub cycle: Duration,
    /// For the constructor, `onInitialize`, `onStart`, `onReset` and `onRecover`.
    pub startup: Duration,
}

impl Default for CallLimits {
    /// Those of a component without rules and without a period.
    fn default() -> Self {
        Self {
            cycle: DEFAULT_PERIODLESS_DEADLINE,
            startup: DEFAULT_STARTUP,
        }
    }
}

impl CallLimits {
    /// As the rules want it for a component that is executed so.
    pub fn by_rules(rules: &ComponentRules, execution: &ExecutionSemantics) -> Self {
        let startup = rules.watchdog.as_ref().map(|rule| rule.value.startup);
        Self {
            cycle: rules.watchdog_deadline(execution),
            startup: startup.unwrap_or(DEFAULT_STARTUP),
        }
    }

    /// Of a callback.
    pub(super) fn of(self, callback: Callback) -> Duration {
        match callback {
            Callback::Create
            | Callback::Initialize
            | Callback::Start
            | Callback::Reset
            | Callback::Recover => self.startup,
            _ => self.cycle,
        }
    }

    /// The same for an application that runs by this clock: not below 1 s in simulated time.
    #[must_use]
    pub fn by_clock(self, clock: &Clock) -> Self {
        let shortest = match clock {
            Clock::Real(_) => Duration::ZERO,
            Clock::Simulated(_) => SHORTEST_IN_SIMULATION,
        };
        let at_least = |limit: Duration| {
            if limit.is_zero() {
                limit
            } else {
                limit.max(shortest)
            }
        };
        Self {
            cycle: at_least(self.cycle),
            startup: at_least(self.startup),
        }
    }
}

/// The limits as the guard wants them: worked out once, not at every call.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    cycle: CallLimit,
    startup: CallLimit,
    shutdown: CallLimit,
}

impl From<CallLimits> for Limits {
    fn from(limits: CallLimits) -> Self {
        let shutdown = if limits.cycle.is_zero() {
            limits.cycle
        } else {
            limits.cycle.max(SHORTEST_SHUTDOWN)
        };
        Self {
            cycle: limits.cycle.into(),
            startup: limits.startup.into(),
            shutdown: shutdown.into(),
        }
    }
}

impl Limits {
    #[inline]
    pub(super) fn of(&self, callback: Callback) -> CallLimit {
        match callback {
            Callback::Create
            | Callback::Initialize
            | Callback::Start
            | Callback::Reset
            | Callback::Recover => self.startup,
            Callback::Stop | Callback::Destroy | Callback::DestroyInstance => self.shutdown,
            Callback::Execute
            | Callback::Updated
            | Callback::Error
            | Callback::PeriodChanged(_)
            | Callback::Event(..)
            | Callback::Call(_) => self.cycle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_callback_has_its_limit() {
        let (short, long) = (Duration::from_millis(30), Duration::from_secs(5));
        let limits = CallLimits {
            cycle: short,
            startup: long,
        };
        let second = Duration::from_secs(1);
        for (clock, cycle) in [(Clock::real(), short), (Clock::simulated(), second)] {
            let limits = Limits::from(limits.by_clock(&clock));
            for (callback, expected) in [
                (Callback::Execute, cycle),
                (Callback::Event(0, std::ptr::null(), 0), cycle),
                (Callback::Initialize, long),
                (Callback::Reset, long),
                (Callback::Stop, second),
            ] {
                assert_eq!(limits.of(callback).duration(), expected, "{callback:?}");
            }
        }
    }

    #[test]
    fn zero_is_no_limit_whatever_the_clock() {
        let none = CallLimits {
            cycle: Duration::ZERO,
            startup: Duration::ZERO,
        };
        let limits = Limits::from(none.by_clock(&Clock::simulated()));
        for callback in [Callback::Execute, Callback::Start, Callback::Stop] {
            assert_eq!(limits.of(callback), CallLimit::NONE);
        }
    }
}
