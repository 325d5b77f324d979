//! A container without components: it carries out what the fault manager asks for as a step says,
//! and checks every effect.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use fault_manager::{
    Action, ActionOutcome, DetectorKind, Effect, Evidence, FaultId, FaultManager, Observation,
    PlannedAction, Scope, Symptom, Verdict,
};
use system_model::fault::FaultKind;
use system_model::rules::ComponentSeverity;

use crate::fact::Fact;
use crate::generators::{Answer, Step};
use crate::oracle::Level;

/// More ticks than any ladder of a test has rungs: what wants more turns in a circle.
const MOST_TICKS: usize = 2_000;

/// The container.
pub struct Shell {
    pub manager: FaultManager,
    pub scopes: Vec<Scope>,
    pub now: Duration,
    pub facts: Vec<Fact>,
    pub open: Vec<PlannedAction>,
    pub verdicts: BTreeMap<FaultId, Verdict>,
    /// Faults that were a consequence at some time.
    pub consequences: BTreeSet<FaultId>,
    /// Whether an emergency stop has been asked for since the last rearming.
    pub stop_asked: bool,
    /// Every effect, for comparison.
    pub log: Vec<Effect>,
}

impl Shell {
    pub fn new(scopes: Vec<Scope>) -> Self {
        let count = scopes
            .iter()
            .map(|scope| scope.specification.components.len());
        let fact = Fact {
            incarnation: 1,
            in_error: false,
            open: None,
            awaits_first_cycle: false,
            down: Level::Up,
            resets: Vec::new(),
            in_vain: 0,
            replacements: 0,
            replacing: false,
        };
        let mut shell = Self {
            facts: vec![fact; count.sum()],
            manager: FaultManager::new(scopes.clone()),
            scopes,
            now: Duration::ZERO,
            open: Vec::new(),
            verdicts: BTreeMap::new(),
            consequences: BTreeSet::new(),
            stop_asked: false,
            log: Vec::new(),
        };
        shell.tell(Observation::Running);
        shell
    }

    /// Lets something happen.
    pub fn step(&mut self, step: &Step) {
        let count = self.facts.len();
        match step {
            Step::Crash(one) => self.crash(one % count),
            Step::Complain(one, kind) => self.complain(one % count, *kind),
            Step::Passed(one, kind) => {
                let (kind, _) = complaint(*kind);
                let detector = self.manager.detector(one % count, &kind);
                self.tell(Observation::Passed(detector.expect("it has it")));
            }
            Step::Answer(one, answer) => {
                if !self.open.is_empty() {
                    let action = self.open.remove(one % self.open.len());
                    self.answer(&action, *answer);
                }
            }
            Step::Works(one) => self.works(one % count),
            Step::Wait(milliseconds) => self.wait(Duration::from_millis(*milliseconds)),
            Step::ClearOne(one) => {
                let listed: Vec<(FaultId, String)> = self
                    .manager
                    .verdicts()
                    .map(|verdict| (verdict.id, verdict.component.clone()))
                    .collect();
                if !listed.is_empty() {
                    let (id, component) = &listed[one % listed.len()];
                    self.renew_budgets(|name| name == component);
                    self.tell(Observation::Clear(Some(*id)));
                }
            }
            Step::ClearAll => {
                self.renew_budgets(|_| true);
                self.tell(Observation::Clear(None));
            }
            Step::Restart(one) => self.restart(one % count),
        }
    }

    pub fn crash(&mut self, component: usize) {
        let fact = &mut self.facts[component];
        if fact.in_error || fact.open.is_some() || fact.down > Level::Up {
            return;
        }
        fact.in_error = true;
        fact.awaits_first_cycle = false;
        self.complain_of(component, DetectorKind::Exception, FaultKind::Panic, false);
    }

    fn complain(&mut self, component: usize, kind: usize) {
        let (detector, fault) = complaint(kind);
        self.complain_of(component, detector, fault, true);
    }

    fn complain_of(&mut self, component: usize, kind: DetectorKind, fault: FaultKind, runs: bool) {
        let detector = self.manager.detector(component, &kind).expect("it has it");
        let judgement = self.manager.detectors()[detector.0].judgement;
        self.tell(Observation::Symptom(Box::new(Symptom {
            detector,
            incarnation: self.facts[component].incarnation,
            kind: fault,
            return_code: 0,
            at: self.now,
            runs,
            evidence: Evidence::Heartbeat {
                missed: 1,
                period_ms: 1.0,
            },
        })));
        let rules = self.rules(component);
        let severity = judgement.severity.unwrap_or(rules.default_severity());
        let enough = !runs || rules.confirmation(&judgement).count == 1;
        if severity == ComponentSeverity::Emergency && enough {
            assert!(self.manager.is_emergency(), "an emergency is one at once");
            assert!(self.stop_asked, "and reaches the emergency stop");
        }
    }

    /// An action is done, and its component completes a cycle.
    pub fn finish(&mut self, action: &PlannedAction) {
        self.answer(action, Answer::Done);
        if let Some(component) = action.action.component() {
            self.works(component);
        }
    }

    fn answer(&mut self, action: &PlannedAction, answer: Answer) {
        let component = action.action.component();
        let recovers = matches!(action.action, Action::Reset { .. } | Action::Replace { .. });
        if answer == Answer::Never {
            return;
        }
        let mut incarnation = 0;
        let periodic = component.is_some_and(|component| self.is_periodic(component));
        if let Some(fact) = component.map(|component| &mut self.facts[component])
            && fact.open == Some(action.id)
        {
            fact.open = None;
            if recovers && answer == Answer::Done {
                fact.incarnation += 1;
                fact.in_error = false;
                fact.awaits_first_cycle = true;
                if !periodic {
                    fact.works();
                }
            } else if recovers {
                fact.in_error = true;
            }
            incarnation = fact.incarnation;
        }
        let outcome = match answer {
            Answer::Done => ActionOutcome::Done {
                incarnation,
                note: String::new(),
            },
            _ => ActionOutcome::Failed {
                reason: "it would not".to_owned(),
            },
        };
        let action = action.id;
        self.tell(Observation::Ended { action, outcome });
    }

    fn works(&mut self, component: usize) {
        let fact = &mut self.facts[component];
        if fact.awaits_first_cycle && fact.down == Level::Up {
            fact.awaits_first_cycle = false;
            fact.works();
            let incarnation = fact.incarnation;
            self.tell(Observation::Works {
                component,
                incarnation,
            });
        }
    }

    fn restart(&mut self, component: usize) {
        let fact = &mut self.facts[component];
        if fact.down > Level::Up && fact.open.is_none() {
            fact.down = Level::Up;
            fact.in_error = false;
            fact.incarnation += 1;
            fact.awaits_first_cycle = true;
            self.works(component);
        }
    }

    /// Time passes, with every tick that is wanted on the way.
    pub fn wait(&mut self, time: Duration) {
        let end = self.now + time;
        for _ in 0..MOST_TICKS {
            let due = self.manager.due().filter(|due| *due <= end);
            self.now = due.unwrap_or(end).max(self.now);
            self.tell(Observation::Tick);
            if due.is_none() {
                return;
            }
        }
        panic!("the fault manager wants a tick again and again");
    }

    /// Everything that is asked for is done, and all that can end ends.
    pub fn come_to_rest(&mut self) {
        for _ in 0..MOST_TICKS {
            if !self.open.is_empty() {
                let action = self.open.remove(0);
                self.answer(&action, Answer::Done);
            } else if let Some(component) = self.awaiting() {
                self.works(component);
            } else if let Some(due) = self.manager.due() {
                self.wait(due.saturating_sub(self.now));
            } else {
                return;
            }
        }
        panic!("it does not come to rest");
    }

    fn awaiting(&self) -> Option<usize> {
        let awaits = |fact: &Fact| fact.awaits_first_cycle && fact.down == Level::Up;
        self.facts.iter().position(awaits)
    }

    /// Makes an observation and checks what comes of it.
    pub fn tell(&mut self, observation: Observation) {
        let latched = self.manager.is_emergency();
        let effects = self.manager.observe(self.now, observation);
        self.log.extend(effects.iter().cloned());
        for effect in &effects {
            if let Effect::Record(verdict) = effect {
                self.keep(verdict);
            }
        }
        self.check_causes(&effects);
        let mut latched = latched;
        for effect in &effects {
            match effect {
                Effect::Act(act) => self.act(act, latched),
                Effect::Abandon(id) => self.abandon(*id),
                Effect::Rearm => {
                    latched = false;
                    self.stop_asked = false;
                }
                Effect::Record(_) => {}
            }
        }
        self.check_stops(&effects);
    }
}

/// Detectors that complain of a component that runs.
fn complaint(kind: usize) -> (DetectorKind, FaultKind) {
    match kind % 3 {
        0 => (DetectorKind::Overrun, FaultKind::Overrun),
        1 => (DetectorKind::Freshness { port: 0 }, FaultKind::Stale),
        _ => (DetectorKind::FaultEvent(None), FaultKind::Reported),
    }
}
