//! The life of one fault: from its first symptom through the debounce until it is over.

use std::collections::VecDeque;
use std::time::Duration;

use system_model::fault::FaultKind;

use crate::detectors::Terms;
use crate::observation::{DetectorId, Symptom};
use crate::plan::ActionId;
use crate::system::Component;
use crate::verdict::{ActionRecord, Cause, FaultId, FaultState, Severity, Verdict};

/// Symptoms that a debounce within a time can ask for: one second of a detector that runs at
/// 1 kHz. A rule that asks for more is confirmed by so many.
const MAX_SYMPTOMS_WITHIN: u32 = 1_000;

/// Plan sentences and actions that one verdict keeps. A ladder has 100 resets at most, and a stop
/// names each component; a latched fault that is handled again and again forgets the oldest.
const MAX_LINES: usize = 256;

/// What a fault waits for before it is decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wait {
    /// That the handling of its root cause has ended.
    Root(FaultId),
    /// That an operator clears the emergency stop.
    Clearance,
}

/// One fault and its verdict.
#[derive(Debug, Clone)]
pub(crate) struct Fault {
    pub verdict: Verdict,
    pub detector: DetectorId,
    pub component: usize,
    pub kind: FaultKind,
    /// By what its symptoms are judged.
    pub terms: Terms,
    /// Only an operator ends it.
    pub latched: bool,
    /// Whether the component runs nevertheless.
    pub runs: bool,
    pub waits: Option<Wait>,
    /// Actions under way.
    pub pending: usize,
    pub handled_at: Option<Duration>,
    pub healed_at: Option<Duration>,
    /// When the fault manager heard of the last symptom.
    pub last_heard: Duration,
    /// Symptoms of the debounce.
    recent: VecDeque<Duration>,
    in_a_row: u32,
    confirmed_at: Duration,
    planned_at: Option<Duration>,
    /// Numbers of the actions of the verdict.
    actions: VecDeque<ActionId>,
}

impl Fault {
    /// A fault that may become one, without its first symptom.
    pub fn new(
        id: FaultId,
        component: &Component,
        index: usize,
        terms: Terms,
        of: Symptom,
    ) -> Self {
        Self {
            verdict: Verdict {
                id,
                state: FaultState::Prefailed,
                kind: of.kind.name(),
                component: component.name.clone(),
                incarnation: of.incarnation,
                node: component.node.clone(),
                rule: terms.place.as_ref().map(ToString::to_string),
                evidence: of.evidence,
                symptoms: 0,
                first_symptom_ns: nanoseconds(of.at),
                confirmed_ns: 0,
                cause: Cause::Root,
                severity: Severity::from(terms.severity),
                plan: Vec::new(),
                actions: Vec::new(),
                detection_us: 0,
                decision_us: 0,
                handling_us: None,
            },
            detector: of.detector,
            component: index,
            kind: of.kind,
            latched: terms.latched,
            terms,
            runs: true,
            waits: None,
            pending: 0,
            handled_at: None,
            healed_at: None,
            last_heard: Duration::ZERO,
            recent: VecDeque::new(),
            in_a_row: 0,
            confirmed_at: Duration::ZERO,
            planned_at: None,
            actions: VecDeque::new(),
        }
    }

    /// Whether symptoms of this kind, judged so, belong to it.
    pub fn is_of(&self, detector: DetectorId, kind: FaultKind, terms: &Terms) -> bool {
        self.detector == detector && self.kind == kind && self.terms == *terms
    }

    /// The same trouble as a new fault, a root cause: nothing was planned for it yet.
    pub fn anew(&self, id: FaultId) -> Self {
        let mut fault = self.clone();
        fault.verdict.id = id;
        fault.verdict.state = FaultState::Confirmed;
        fault.verdict.cause = Cause::Root;
        fault.verdict.plan.clear();
        fault.verdict.actions.clear();
        fault.verdict.handling_us = None;
        fault.verdict.decision_us = 0;
        fault.waits = None;
        fault.pending = 0;
        fault.handled_at = None;
        fault.healed_at = None;
        fault.planned_at = None;
        fault.actions.clear();
        fault
    }

    /// Takes a symptom in that was seen at this time, of a component that runs or does not; says
    /// whether the debounce is satisfied. A component that does not run any
    /// more cannot show a second symptom: the first one is enough.
    pub fn take(&mut self, at: Duration, runs: bool, now: Duration) -> bool {
        let at = at.min(now);
        self.last_heard = now;
        self.runs &= runs;
        self.verdict.symptoms = self.verdict.symptoms.saturating_add(1);
        let enough = match self.terms.confirmation.within {
            None => {
                self.in_a_row = self.in_a_row.saturating_add(1);
                if self.in_a_row == 1 {
                    self.begin(at);
                }
                self.in_a_row >= self.terms.confirmation.count
            }
            Some(within) => self.take_within(at, within),
        };
        enough || !runs
    }

    fn take_within(&mut self, at: Duration, within: Duration) -> bool {
        self.recent.push_back(at);
        while self
            .recent
            .front()
            .is_some_and(|first| first.saturating_add(within) < at)
        {
            self.recent.pop_front();
        }
        let count = self.terms.confirmation.count.clamp(1, MAX_SYMPTOMS_WITHIN);
        while self.recent.len() > usize::try_from(count).unwrap_or(usize::MAX) {
            self.recent.pop_front();
        }
        self.begin(self.recent.front().copied().unwrap_or(at));
        self.recent.len() >= usize::try_from(count).unwrap_or(usize::MAX)
    }

    /// The first symptom of those that count; later it is what it was when the fault was confirmed.
    fn begin(&mut self, at: Duration) {
        if self.verdict.state == FaultState::Prefailed {
            self.verdict.first_symptom_ns = nanoseconds(at);
        }
    }

    /// When symptoms that are too few for a fault are forgotten; never without a time in the rule.
    pub fn forgotten_at(&self) -> Option<Duration> {
        let within = self.terms.confirmation.within?;
        (self.verdict.state == FaultState::Prefailed)
            .then(|| self.last_heard.saturating_add(within))
    }

    /// Whether one good datum takes back what was seen so far.
    pub fn counts_in_a_row(&self) -> bool {
        self.terms.confirmation.within.is_none()
    }

    /// It is a fault from now on.
    pub fn confirm(&mut self, now: Duration) {
        let first = Duration::from_nanos(self.verdict.first_symptom_ns);
        self.verdict.state = FaultState::Confirmed;
        self.verdict.confirmed_ns = nanoseconds(now);
        self.verdict.detection_us = microseconds(now.saturating_sub(first));
        self.confirmed_at = now;
        self.begin_debounce_anew();
    }

    /// Later symptoms count from here.
    pub fn begin_debounce_anew(&mut self) {
        self.recent.clear();
        self.in_a_row = 0;
    }

    /// When the first of the symptoms was.
    pub fn first_symptom(&self) -> Duration {
        Duration::from_nanos(self.verdict.first_symptom_ns)
    }

    /// Adds a sentence to the plan; a fault that had been handled is handled again.
    pub fn plan(&mut self, sentence: String, now: Duration) {
        if self.planned_at.is_none() {
            self.verdict.decision_us = microseconds(now.saturating_sub(self.confirmed_at));
        }
        if self.planned_at.is_none() || self.handled_at.take().is_some() {
            self.planned_at = Some(now);
            self.verdict.handling_us = None;
        }
        if self.verdict.plan.len() == MAX_LINES {
            self.verdict.plan.remove(0);
        }
        self.verdict.plan.push(sentence);
    }

    /// An action is under way for it.
    pub fn begin_action(&mut self, id: ActionId, action: String) {
        if self.verdict.actions.len() == MAX_LINES {
            self.verdict.actions.remove(0);
            self.actions.pop_front();
        }
        self.verdict.actions.push(ActionRecord {
            action,
            outcome: "under_way",
            note: String::new(),
        });
        self.actions.push_back(id);
        self.pending += 1;
    }

    /// What became of an action; it may be said more than once.
    pub fn record_outcome(&mut self, id: ActionId, outcome: &'static str, note: String) {
        let position = self.actions.iter().position(|own| *own == id);
        if let Some(record) = position.and_then(|index| self.verdict.actions.get_mut(index)) {
            record.outcome = outcome;
            record.note = note;
        }
    }

    /// Nothing more is done for it.
    pub fn finish(&mut self, now: Duration) {
        let planned = self.planned_at.unwrap_or(now);
        self.handled_at = Some(now);
        self.verdict.handling_us = Some(microseconds(now.saturating_sub(planned)));
    }

    /// Whether it is a fault that is being handled, or waits for it.
    pub fn is_being_handled(&self) -> bool {
        self.pending > 0 || self.waits.is_some() || self.handled_at.is_none()
    }

    /// Whether it may be forgotten.
    pub fn is_history(&self) -> bool {
        self.verdict.state == FaultState::Cleared && self.waits.is_none() && self.pending == 0
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

fn microseconds(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
}
