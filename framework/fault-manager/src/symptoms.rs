//! From symptoms to faults: arming, the queue during a recovery, the debounce, and how faults heal
//! and are over.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use system_model::rules::{Arming, ComponentSeverity};

use crate::correlation::CORRELATION_WINDOW;
use crate::life::{Fault, Wait};
use crate::manager::FaultManager;
use crate::observation::{DetectorId, DetectorKind, Symptom};
use crate::plan::ActionId;
use crate::state::ComponentState;
use crate::verdict::{Cause, FaultId, FaultState};

/// A fault that has healed is over when nothing has been heard of it for so long. As long as it can
/// still be the cause of others, a person who looks sees it as healed.
const QUIET_TIME: Duration = CORRELATION_WINDOW;

impl FaultManager {
    /// The application runs: what failed before is judged now.
    pub(crate) fn run(&mut self) {
        self.running = true;
        for component in 0..self.components.len() {
            if let Some(symptom) = self.components[component].held.take() {
                self.symptom(symptom);
            }
        }
    }

    /// A detector has found something wrong.
    pub(crate) fn symptom(&mut self, symptom: Symptom) {
        let Some(detector) = self.detectors.all.get(symptom.detector.0) else {
            return;
        };
        let component = detector.component;
        let kind = &detector.kind;
        let failure = !symptom.runs && matches!(kind, DetectorKind::Exception | DetectorKind::Hang);
        let terms = self.detectors.terms(&self.system, &symptom);
        let state = &mut self.components[component];
        state.incarnation = state.incarnation.max(symptom.incarnation);
        if !self.running && terms.arming == Arming::Running {
            // A component in ERROR shows nothing more, so the first failure is the only one. It is
            // recovered when the application runs; other symptoms will come again then.
            if failure {
                state.held.get_or_insert(symptom);
            }
            return;
        }
        let recovery = state.recovery().map(|work| (work.fault, work.ended));
        match recovery {
            Some((owner, ended)) if terms.severity != ComponentSeverity::Emergency => {
                self.symptom_in_recovery(component, owner, ended, symptom);
            }
            _ => self.judge(symptom),
        }
    }

    /// Of a component in the middle of its own recovery: what the new instance cannot live through
    /// is the end of that attempt; anything else is judged when the attempt has ended.
    fn symptom_in_recovery(
        &mut self,
        component: usize,
        owner: FaultId,
        ended: Option<u32>,
        symptom: Symptom,
    ) {
        let of_new_instance = ended.is_some_and(|new| symptom.incarnation >= new);
        if of_new_instance && !symptom.runs {
            let kind = symptom.kind;
            self.judge(symptom);
            let reason = format!("{kind} before its first cycle was completed");
            self.recovery_failed(component, "failed", reason);
        } else if self.components[component].enqueue(symptom)
            && let Some(fault) = self.history.get_mut(owner)
        {
            fault.verdict.symptoms = fault.verdict.symptoms.saturating_add(1);
        }
    }

    /// Passes a symptom through the debounce.
    pub(crate) fn judge(&mut self, symptom: Symptom) {
        let terms = self.detectors.terms(&self.system, &symptom);
        let component = self.detectors.all[symptom.detector.0].component;
        let (at, runs) = (symptom.at, symptom.runs);
        let open = self
            .history
            .fault_of(symptom.detector, symptom.kind, &terms);
        let id = open.unwrap_or_else(|| self.history.number());
        match self.history.get_mut(id) {
            Some(fault) => fault.verdict.evidence = symptom.evidence,
            None => {
                let named = &self.system.components[component];
                let fault = Fault::new(id, named, component, terms, symptom);
                self.history.insert(fault);
            }
        }
        let now = self.now;
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        let ran = fault.runs;
        let enough = fault.take(at, runs, now);
        match fault.verdict.state {
            FaultState::Prefailed if enough => self.confirm(id),
            FaultState::Prefailed => {}
            _ => self.again(id, enough, ran),
        }
    }

    /// It is a fault. One of the same kind that had healed is over by that.
    fn confirm(&mut self, id: FaultId) {
        let now = self.now;
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        fault.confirm(now);
        let (detector, kind, terms) = (fault.detector, fault.kind, fault.terms.clone());
        let healed = self.history.which(|other| {
            other.verdict.state == FaultState::Healed && other.is_of(detector, kind, &terms)
        });
        for other in healed {
            self.set_state(other, FaultState::Cleared);
        }
        self.changed.insert(id);
        self.diagnose(id);
    }

    /// Another symptom of a fault that is one already.
    fn again(&mut self, id: FaultId, enough: bool, ran: bool) {
        let Some(fault) = self.history.get(id) else {
            return;
        };
        let (severity, runs, cause) = (fault.terms.severity, fault.runs, fault.verdict.cause);
        let state = &self.components[fault.component];
        if severity == ComponentSeverity::Emergency {
            if enough {
                self.raise_emergency(id);
            }
            return;
        }
        let is_handled = self.handled_by_tree(fault.component).is_some();
        if fault.waits.is_some() || state.down.is_some() || state.recovery().is_some() || is_handled
        {
            return;
        }
        match (cause, severity) {
            (Cause::ConsequenceOf(_), _) => self.doubt(id),
            (Cause::Root, ComponentSeverity::Ignore) if ran && !runs => self.lose(id),
            (Cause::Root, ComponentSeverity::Ignore) => {}
            (Cause::Root, _) if enough => self.decide(id),
            (Cause::Root, _) => {}
        }
    }

    /// A detector finds that all is well again.
    pub(crate) fn passed(&mut self, detector: DetectorId) {
        let Some(component) = self.detectors.all.get(detector.0).map(|own| own.component) else {
            return;
        };
        // What has passed before its turn belongs to the recovery under way.
        let queue = std::mem::take(&mut self.components[component].queue);
        let passes = |symptom: &Symptom| symptom.runs && symptom.detector == detector;
        let (over, left): (VecDeque<_>, VecDeque<_>) = queue.into_iter().partition(passes);
        self.components[component].queue = left;
        for symptom in over {
            self.judge(symptom);
        }
        for id in self.history.which(|fault| fault.detector == detector) {
            self.pass(id);
        }
    }

    fn pass(&mut self, id: FaultId) {
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        match fault.verdict.state {
            FaultState::Prefailed if fault.counts_in_a_row() => self.history.remove(id),
            FaultState::Confirmed => {
                fault.begin_debounce_anew();
                if fault.runs && fault.waits == Some(Wait::Clearance) && !self.is_latched(id) {
                    self.give_up_waiting(id);
                    self.heal(id);
                } else if self.may_heal_by_itself(id) {
                    self.heal(id);
                }
            }
            _ => {}
        }
    }

    /// Whether a fault can end without a recovery: nothing is done or to be done for it, and its
    /// component runs.
    fn may_heal_by_itself(&self, id: FaultId) -> bool {
        self.history.get(id).is_some_and(|fault| {
            let down = self.components[fault.component].down;
            fault.runs && !fault.is_being_handled() && down.is_none_or(|down| down.by != id)
        })
    }

    /// The symptoms are gone, or the component was recovered.
    pub(crate) fn heal(&mut self, id: FaultId) {
        let latched = self.is_latched(id);
        let now = self.now;
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        fault.begin_debounce_anew();
        if fault.verdict.state == FaultState::Confirmed && !latched {
            fault.healed_at = Some(now);
            self.set_state(id, FaultState::Healed);
        }
    }

    /// Whether only an operator ends the fault.
    pub(crate) fn is_latched(&self, id: FaultId) -> bool {
        let behind = self
            .emergency
            .as_ref()
            .is_some_and(|stop| stop.is_behind(id));
        behind || self.history.get(id).is_some_and(|fault| fault.latched)
    }

    /// Changes the state of a fault, for the record.
    pub(crate) fn set_state(&mut self, id: FaultId, state: FaultState) {
        if let Some(fault) = self.history.get_mut(id) {
            fault.verdict.state = state;
            self.changed.insert(id);
        }
    }

    /// When time alone changes something about a fault.
    pub(crate) fn life_due(&self, fault: &Fault) -> Option<Duration> {
        match fault.verdict.state {
            FaultState::Prefailed => fault.forgotten_at(),
            FaultState::Healed => fault.healed_at.map(|at| at.saturating_add(QUIET_TIME)),
            FaultState::Confirmed if self.fades(fault) => {
                Some(fault.last_heard.saturating_add(QUIET_TIME))
            }
            FaultState::Confirmed | FaultState::Cleared => None,
        }
    }

    /// Whether the fault is an occurrence rather than a condition: nothing tells that it is gone but
    /// that it does not come again.
    fn fades(&self, fault: &Fault) -> bool {
        let occurrence = matches!(
            self.detectors.all[fault.detector.0].kind,
            DetectorKind::Exception | DetectorKind::Hang | DetectorKind::FaultEvent(_)
        );
        let id = fault.verdict.id;
        occurrence && self.may_heal_by_itself(id) && !self.is_latched(id)
    }

    /// What time alone changes: overdue actions, debounces and quiet times that are over.
    pub(crate) fn elapse(&mut self, reached: impl Fn(Duration) -> bool) {
        let late = |state: &ComponentState| {
            let work = state.work.as_ref();
            work.filter(|work| reached(work.deadline))
                .map(|work| work.id)
        };
        let states = self.components.iter().enumerate();
        let overdue: BTreeMap<usize, ActionId> = states
            .filter_map(|(component, state)| Some((component, late(state)?)))
            .collect();
        for component in self.graph.stop_order(&overdue.keys().copied().collect()) {
            // What one of them entails may have ended the action of another.
            let work = self.components[component].work.as_ref();
            if work.is_some_and(|work| Some(&work.id) == overdue.get(&component)) {
                self.overdue(component);
            }
        }
        self.emergency_overdue(&reached);
        self.look_at_trees(&reached);
        self.settle();
        for id in self
            .history
            .which(|fault| self.life_due(fault).is_some_and(&reached))
        {
            match self.history.get(id).map(|fault| fault.verdict.state) {
                Some(FaultState::Prefailed) => self.history.remove(id),
                Some(FaultState::Healed) => self.set_state(id, FaultState::Cleared),
                Some(FaultState::Confirmed) => self.heal(id),
                Some(FaultState::Cleared) | None => {}
            }
        }
    }
}
