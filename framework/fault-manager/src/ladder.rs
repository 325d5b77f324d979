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
    /// The task was to go on without it, and did not.
    adapted: bool,
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
    /// The task is to go on without the component.
    Adapt,
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
        if component.rules.adapt.is_some() && !self.adapted {
            self.adapted = true;
            return Rung::Adapt;
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
        self.adapted = false;
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
        self.adapted = false;
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
mod tests;
