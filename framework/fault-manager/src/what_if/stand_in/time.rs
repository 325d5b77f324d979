//! What time brings, and what the fault manager makes of what was observed.

use std::time::Duration;

use super::StandIn;
use super::orders::Order;
use crate::observation::Observation;
use crate::plan::Effect;
use crate::verdict::{FaultState, Verdict};

impl StandIn<'_> {
    /// When time alone brings something, at the latest.
    pub(super) fn tick_due(&self) -> Duration {
        let matures = self.matures.iter().map(|(due, _)| *due).min();
        let later = self.later.iter().map(|(due, _)| *due).min();
        let due = [self.manager.due(), matures, later].into_iter().flatten();
        due.chain([self.looks.due]).min().unwrap_or_default()
    }

    /// What time brings: what can be observed now, looks of monitors, orders, deadlines.
    pub(super) fn tick(&mut self) {
        let now = self.now;
        let (due, rest) = std::mem::take(&mut self.matures)
            .into_iter()
            .partition(|(at, _)| *at <= now);
        self.matures = rest;
        let due: Vec<(Duration, Observation)> = due;
        let of_now = |observation: &Observation| match observation {
            Observation::Symptom(symptom) => {
                let component = self.manager.detectors.all[symptom.detector.0].component;
                self.components[component].incarnation == symptom.incarnation
            }
            _ => true,
        };
        let due = due.into_iter().map(|(_, observation)| observation);
        let due: Vec<Observation> = due.filter(of_now).collect();
        self.observations.extend(due);
        self.look();
        let (due, rest) = std::mem::take(&mut self.later)
            .into_iter()
            .partition(|(at, _)| *at <= now);
        self.later = rest;
        let due: Vec<(Duration, Order)> = due;
        for (_, order) in due {
            self.give(order);
        }
        if self.manager.due().is_some_and(|due| due <= now) {
            self.observations.push_back(Observation::Tick);
        }
        self.attend();
    }

    /// Lets the fault manager see what was observed.
    pub(super) fn attend(&mut self) {
        while let Some(observation) = self.observations.pop_front() {
            for effect in self.manager.observe(self.now, observation) {
                match effect {
                    Effect::Act(planned) => {
                        self.last_change = self.now;
                        self.act(&planned);
                    }
                    Effect::Abandon(action) => {
                        self.later.retain(|(_, order)| order.action != Some(action));
                    }
                    Effect::Record(verdict) => self.record(*verdict),
                    // Nobody clears an emergency stop here.
                    Effect::Rearm => {}
                }
            }
        }
    }

    fn record(&mut self, verdict: Verdict) {
        // A fault that is only recorded may be recorded for ever: that it begins is what counts.
        let known = self.verdicts.get(&verdict.id);
        let repeats = |other: &Verdict| {
            let same = |one: &Verdict| {
                one.kind == verdict.kind
                    && one.component == verdict.component
                    && one.cause == verdict.cause
            };
            same(other) && other.actions.is_empty() && verdict.actions.is_empty()
        };
        let again = known.is_none() && self.verdicts.values().any(repeats);
        if !again && verdict.state != FaultState::Prefailed {
            if known.is_none() {
                self.last_change = self.now;
            }
            self.verdicts.insert(verdict.id, verdict);
        }
    }
}
