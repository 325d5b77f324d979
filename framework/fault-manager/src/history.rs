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

/// Faults that are over and may still lie among the others, so that nobody need put them away in the
/// middle of a recovery: so few that it costs nothing to pass over them.
const CLEARED_AMONG_OPEN: usize = 4;

/// Faults by number. Those that are over lie apart: every observation looks through the others.
#[derive(Debug)]
pub(crate) struct History {
    open: BTreeMap<FaultId, Fault>,
    over: BTreeMap<FaultId, Fault>,
    last: u64,
}

impl History {
    /// Nothing has happened.
    pub fn new() -> Self {
        Self {
            open: BTreeMap::new(),
            over: BTreeMap::new(),
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
        self.open.insert(fault.verdict.id, fault);
    }

    /// A fault, unless it has been forgotten.
    pub fn get(&self, id: FaultId) -> Option<&Fault> {
        self.open.get(&id).or_else(|| self.over.get(&id))
    }

    /// A fault, unless it has been forgotten.
    pub fn get_mut(&mut self, id: FaultId) -> Option<&mut Fault> {
        self.open.get_mut(&id).or_else(|| self.over.get_mut(&id))
    }

    /// Forgets a fault that never became one.
    pub fn remove(&mut self, id: FaultId) {
        self.open.remove(&id);
    }

    /// Those that are not over, oldest first; a few that are may be among them.
    pub fn open(&self) -> impl Iterator<Item = &Fault> {
        self.open.values()
    }

    /// All of them, oldest first.
    pub fn all(&self) -> impl Iterator<Item = &Fault> {
        let (mut open, mut over) = (self.open.values().peekable(), self.over.values().peekable());
        std::iter::from_fn(move || match (open.peek(), over.peek()) {
            (Some(one), Some(other)) if one.verdict.id > other.verdict.id => over.next(),
            (Some(_), _) => open.next(),
            (None, _) => over.next(),
        })
    }

    /// Numbers of those that are not over and that a question is answered with yes for, oldest
    /// first.
    pub fn which(&self, question: impl Fn(&Fault) -> bool) -> Vec<FaultId> {
        let matching = self.open.values().filter(|fault| question(fault));
        matching.map(|fault| fault.verdict.id).collect()
    }

    /// The fault that a symptom belongs to: of the same detector and kind, judged by the same rule,
    /// not healed yet.
    pub fn fault_of(
        &self,
        detector: DetectorId,
        kind: FaultKind,
        terms: &Terms,
    ) -> Option<FaultId> {
        let same = self.open.values().rev().find(|fault| {
            let state = fault.verdict.state;
            matches!(state, FaultState::Prefailed | FaultState::Confirmed)
                && fault.is_of(detector, kind, terms)
        });
        same.map(|fault| fault.verdict.id)
    }

    /// Puts those that are over away, and forgets the oldest of them; `hurried`: only if they have
    /// become many.
    pub fn tidy(&mut self, hurried: bool) {
        let is_over = |fault: &&Fault| fault.is_history();
        let many = self.open.values().filter(is_over).count() > CLEARED_AMONG_OPEN;
        if hurried && !many {
            return;
        }
        for id in self.which(Fault::is_history) {
            if let Some(fault) = self.open.remove(&id) {
                self.over.insert(id, fault);
            }
        }
        while self.over.len() > CLEARED_KEPT {
            self.over.pop_first();
        }
    }

    /// The earliest of the times that an entry names that is not over.
    pub fn earliest(&self, time: impl Fn(&Fault) -> Option<Duration>) -> Option<Duration> {
        self.open.values().filter_map(time).min()
    }
}
