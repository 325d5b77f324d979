//! The ladder of one component: resets within their budget, then the secondaries in order, then
//! nothing is left but what the application says.

use std::collections::VecDeque;
use std::time::Duration;

use system_model::rules::{FaultRule, MAX_RETRY_MAX};

use crate::system::Component;

/// How far a component has climbed.
#[derive(Debug, Default)]
pub(crate) struct Ladder {
    /// When the last resets of the present instance begin, oldest first.
    resets: VecDeque<Duration>,
    /// So many of them came since the component last worked.
    in_vain: usize,
    /// Index of the secondary that is next.
    next_secondary: usize,
    /// A secondary was chosen and has not worked yet: there is nothing that a reset could bring
    /// back.
    replacing: bool,
    /// When a tree was begun last.
    handled_at: Option<Duration>,
}

/// What is to be tried next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Rung {
    /// Recovery in place, not before a time.
    Reset {
        /// Number of this reset within the window, from 1.
        attempt: u32,
        not_before: Duration,
    },
    /// The secondary of this index.
    Replace(usize),
    /// A behaviour tree, once within the window.
    HandleByTree,
    /// Nothing that brings the component back.
    Exhausted,
}

impl Ladder {
    /// Takes the next rung.
    pub fn climb(&mut self, component: &Component, now: Duration) -> Rung {
        let rule = &component.fault;
        let may_reset = component
            .rules
            .resurrect
            .as_ref()
            .is_none_or(|rule| rule.value.reset);
        let used = self.within_window(rule, now);
        if may_reset && !self.replacing && used < rule.retry_max.min(MAX_RETRY_MAX) {
            let last = self.resets.back().filter(|_| used > 0);
            let not_before = last.map_or(now, |last| last.saturating_add(rule.backoff).max(now));
            self.resets.push_back(not_before);
            self.in_vain += 1;
            return Rung::Reset {
                attempt: used + 1,
                not_before,
            };
        }
        if self.next_secondary < component.rules.secondaries.len() {
            let secondary = self.next_secondary;
            self.next_secondary += 1;
            self.replacing = true;
            return Rung::Replace(secondary);
        }
        let in_vain = |at: &Duration| at.saturating_add(rule.window) > now;
        if component.rules.handle.is_some() && !self.handled_at.as_ref().is_some_and(in_vain) {
            self.handled_at = Some(now);
            return Rung::HandleByTree;
        }
        Rung::Exhausted
    }

    /// An operator has looked at it: resets are counted from nothing. A secondary that was used up
    /// stays so.
    pub fn renew(&mut self) {
        self.handled_at = None;
        self.renew_resets();
    }

    fn renew_resets(&mut self) {
        self.resets.clear();
        self.in_vain = 0;
        self.replacing = false;
    }

    /// Index of the secondary that is next; beyond the last one if all were used.
    pub fn next_secondary(&self) -> usize {
        self.next_secondary
    }

    /// An operator has chosen a secondary.
    pub fn replace(&mut self, secondary: usize) {
        self.next_secondary = self.next_secondary.max(secondary + 1);
        self.replacing = true;
    }

    /// The component works again: the window is about how often that is. Those of a secondary that
    /// works are counted from nothing.
    pub fn worked(&mut self) {
        self.in_vain = 0;
        if self.replacing {
            self.renew_resets();
        }
    }

    /// Forgets the resets that have left the window and counts the others. Those that were in vain
    /// count however long ago they were: else a component that takes half the window to fail would
    /// be reset for ever.
    fn within_window(&mut self, rule: &FaultRule, now: Duration) -> u32 {
        let left = |reset: &Duration| reset.saturating_add(rule.window) <= now;
        while self.resets.len() > self.in_vain && self.resets.front().is_some_and(left) {
            self.resets.pop_front();
        }
        u32::try_from(self.resets.len()).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use system_model::profile::Located;
    use system_model::rules::{
        ApplicationSeverity, ComponentRules, Preload, ResurrectRule, Secondary,
    };
    use system_model::specification::{
        ComponentSpecification, ExecutionKind, ExecutionSemantics, Place, SchedulingPolicy,
    };

    use super::*;

    fn component(reset: Option<bool>, retry_max: u32, window: u64, backoff: u64) -> Component {
        let resurrect = reset.map(|reset| Located {
            value: ResurrectRule {
                reset,
                backup: None,
                persist: None,
            },
            place: Place::default(),
        });
        Component {
            name: String::new(),
            node: String::new(),
            application: 0,
            executor: 0,
            periodic: true,
            rules: ComponentRules {
                resurrect,
                ..ComponentRules::default()
            },
            fault: FaultRule {
                retry_max,
                window: Duration::from_millis(window),
                backoff: Duration::from_millis(backoff),
                severity: ApplicationSeverity::Local,
            },
            recovery_deadline: Duration::from_secs(1),
        }
    }

    /// Failures at these times; the start of the reset that follows each, or that none does.
    #[test]
    fn resets_are_counted_within_the_window_and_wait_for_the_backoff() {
        type Expected = &'static [(u64, Option<(u32, u64)>)];
        let cases: [(&str, Component, Expected); 6] = [
            (
                "budget of two",
                component(None, 2, 1000, 0),
                &[
                    (0, Some((1, 0))),
                    (5, Some((2, 5))),
                    (10, None),
                    (999, None),
                ],
            ),
            (
                "the first one leaves the window",
                component(Some(true), 2, 1000, 0),
                &[
                    (0, Some((1, 0))),
                    (500, Some((2, 500))),
                    (1000, Some((2, 1000))),
                    (1400, None),
                    (1500, Some((2, 1500))),
                ],
            ),
            (
                "backoff counts from the last reset, and not for the first of a window",
                component(None, 3, 1000, 100),
                &[
                    (0, Some((1, 0))),
                    (5, Some((2, 100))),
                    (105, Some((3, 200))),
                    (1250, Some((1, 1250))),
                ],
            ),
            (
                "forbidden",
                component(Some(false), 3, 1000, 0),
                &[(0, None)],
            ),
            ("no budget", component(None, 0, 1000, 0), &[(0, None)]),
            (
                "time stands still",
                component(None, 2, 1000, 0),
                &[(7, Some((1, 7))), (7, Some((2, 7))), (7, None)],
            ),
        ];
        for (case, component, failures) in cases {
            let mut ladder = Ladder::default();
            for (at, expected) in failures {
                let rung = ladder.climb(&component, Duration::from_millis(*at));
                ladder.worked();
                let reset = expected.map(|(attempt, not_before)| Rung::Reset {
                    attempt,
                    not_before: Duration::from_millis(not_before),
                });
                assert_eq!(rung, reset.unwrap_or(Rung::Exhausted), "{case}, at {at}");
            }
        }
    }

    #[test]
    fn a_replacement_that_never_worked_is_followed_by_the_next_secondary() {
        let mut component = component(None, 1, 1000, 0);
        component.rules.secondaries = vec![secondary(), secondary()];
        let mut ladder = Ladder::default();
        let mut climb = |worked: bool| {
            if worked {
                ladder.worked();
            }
            match ladder.climb(&component, Duration::ZERO) {
                Rung::Reset { .. } => "reset".to_owned(),
                Rung::Replace(secondary) => format!("secondary {secondary}"),
                Rung::HandleByTree => "tree".to_owned(),
                Rung::Exhausted => "exhausted".to_owned(),
            }
        };
        let rungs = [false, false, false, true, false].map(&mut climb);
        let expected = ["reset", "secondary 0", "secondary 1", "reset", "exhausted"];
        assert_eq!(rungs, expected);
    }

    fn secondary() -> Secondary {
        let specification = ComponentSpecification {
            name: String::new(),
            type_name: String::new(),
            profile: PathBuf::new(),
            place: Place::default(),
            library: String::new(),
            execution: ExecutionSemantics {
                kind: ExecutionKind::Periodic,
                period: Duration::from_millis(10),
                priority: 0,
                policy: SchedulingPolicy::Other,
            },
            properties: Vec::new(),
            ports: Vec::new(),
            node: String::new(),
        };
        Secondary {
            specification,
            preload: Preload::Cold,
        }
    }

    #[test]
    fn resets_in_vain_count_however_long_they_took() {
        let component = component(None, 3, 1000, 0);
        let mut ladder = Ladder::default();
        for at in [0, 2_000, 4_000] {
            let rung = ladder.climb(&component, Duration::from_millis(at));
            assert!(matches!(rung, Rung::Reset { .. }), "at {at}");
        }
        let rung = ladder.climb(&component, Duration::from_millis(6_000));
        assert_eq!(rung, Rung::Exhausted);
    }
}
