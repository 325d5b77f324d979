//! What is counted from events: faults by kind, and how long it took to handle each.

use std::collections::BTreeMap;

use fault_manager::{Cause, FaultId, FaultState, Verdict};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::histogram::{Histogram, exponential_buckets};
use system_model::fault::FaultKind;

use crate::event_log::Event;

/// Labels of a figure.
pub(super) type Labels = Vec<(&'static str, String)>;

/// Faults whose verdicts may still change, and that are not to be counted twice. More are never open;
/// of the oldest nothing is heard any more.
const MOST_FAULTS: usize = 1024;

/// The first bucket of recovery times ends at 10 µs, which a guarded component takes at best, and each
/// further one at twice that: the last of these at 10 s.
const FIRST_BUCKET_S: f64 = 1e-5;
const BUCKETS: u16 = 21;

/// What has happened so far.
#[derive(Debug)]
pub struct Tally {
    /// Confirmed faults by `component` and `kind`.
    pub(super) faults: Family<Labels, Counter>,
    /// By `component`: time from the first symptom of a root cause until the last action for it had
    /// ended and the component worked, in seconds.
    pub(super) recoveries: Family<Labels, Histogram>,
    /// Faults that were counted, and whether they had been handled.
    known: BTreeMap<FaultId, bool>,
}

impl Default for Tally {
    fn default() -> Self {
        let histogram: fn() -> Histogram =
            || Histogram::new(exponential_buckets(FIRST_BUCKET_S, 2.0, BUCKETS));
        Self {
            faults: Family::default(),
            recoveries: Family::new_with_constructor(histogram),
            known: BTreeMap::new(),
        }
    }
}

impl Tally {
    /// Takes an event in.
    pub fn take(&mut self, event: &Event) {
        if let Event::Verdict(verdict) = event
            && verdict.kind != FaultKind::OperatorOrder.name()
            && verdict.state != FaultState::Prefailed
        {
            self.take_verdict(verdict);
        }
    }

    /// How many faults are remembered.
    #[cfg(test)]
    pub(super) fn remembered(&self) -> usize {
        self.known.len()
    }

    fn take_verdict(&mut self, verdict: &Verdict) {
        let component = ("component", verdict.component.clone());
        let before = self.known.get(&verdict.id).copied();
        if before.is_none() {
            let kind = ("kind", verdict.kind.to_owned());
            let labels = vec![component.clone(), kind];
            self.faults.get_or_create(&labels).inc();
        }
        let handled = verdict.handling_us.filter(|_| {
            // What is only recorded, or somebody else's fault, is no recovery.
            verdict.cause == Cause::Root && !verdict.actions.is_empty()
        });
        if let Some(handling_us) = handled
            && before != Some(true)
        {
            let total_us = verdict.detection_us + verdict.decision_us + handling_us;
            let time_s = std::time::Duration::from_micros(total_us).as_secs_f64();
            self.recoveries
                .get_or_create(&vec![component])
                .observe(time_s);
        }
        self.known.insert(verdict.id, handled.is_some());
        while self.known.len() > MOST_FAULTS {
            self.known.pop_first();
        }
    }
}
