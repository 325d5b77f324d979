//! All faults that are remembered.

use std::collections::BTreeMap;
use std::time::Duration;

use system_model::fault::FaultKind;

use crate::detectors::Terms;
use crate::life::Fault;
use crate::observation::DetectorId;
use crate::verdict::{FaultId, FaultState};

/// Faults that are over and still listed: an hour of a fault every fifteen seconds. Every one of
/// them is in the event file too.
const CLEARED_KEPT: usize = 256;

/// Faults by number.
#[derive(Debug)]
pub(crate) struct History {
    faults: BTreeMap<FaultId, Fault>,
    last: u64,
}

impl History {
    /// Nothing has happened.
    pub fn new() -> Self {
        Self {
            faults: BTreeMap::new(),
            last: 0,
        }
    }

    /// The next number.
    pub fn number(&mut self) -> FaultId {
        self.last += 1;
        FaultId(self.last)
    }

    /// Keeps a new fault.
    pub fn insert(&mut self, fault: Fault) {
        self.faults.insert(fault.verdict.id, fault);
    }

    /// A fault, unless it has been forgotten.
    pub fn get(&self, id: FaultId) -> Option<&Fault> {
        self.faults.get(&id)
    }

    /// A fault, unless it has been forgotten.
    pub fn get_mut(&mut self, id: FaultId) -> Option<&mut Fault> {
        self.faults.get_mut(&id)
    }

    /// Forgets a fault that never became one.
    pub fn remove(&mut self, id: FaultId) {
        self.faults.remove(&id);
    }

    /// All of them, oldest first.
    pub fn all(&self) -> impl DoubleEndedIterator<Item = &Fault> {
        self.faults.values()
    }

    /// Numbers of those that a question is answered with yes for, oldest first.
    pub fn which(&self, question: impl Fn(&Fault) -> bool) -> Vec<FaultId> {
        let matching = self.faults.values().filter(|fault| question(fault));
        matching.map(|fault| fault.verdict.id).collect()
    }

    /// The fault that a symptom belongs to: of the same detector and kind, judged by the same rule,
    /// not healed yet.
    pub fn open(&self, detector: DetectorId, kind: FaultKind, terms: &Terms) -> Option<FaultId> {
        let same = self.faults.values().rev().find(|fault| {
            let state = fault.verdict.state;
            matches!(state, FaultState::Prefailed | FaultState::Confirmed)
                && fault.is_of(detector, kind, terms)
        });
        same.map(|fault| fault.verdict.id)
    }

    /// Forgets the oldest of those that are over.
    pub fn trim(&mut self) {
        let over = self.which(Fault::is_history);
        let surplus = over.len().saturating_sub(CLEARED_KEPT);
        for id in over.into_iter().take(surplus) {
            self.faults.remove(&id);
        }
    }

    /// The earliest of the times that an entry names.
    pub fn earliest(&self, time: impl Fn(&Fault) -> Option<Duration>) -> Option<Duration> {
        self.faults.values().filter_map(time).min()
    }
}
