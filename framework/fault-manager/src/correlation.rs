//! Root cause or consequence.

use std::time::Duration;

use system_model::rules::{ComponentSeverity, PortRules};
use system_model::specification::PortDirection;

use crate::life::{Fault, Wait};
use crate::manager::FaultManager;
use crate::observation::DetectorKind;
use crate::verdict::{Cause, FaultId, FaultState, Severity};
use crate::wording;

/// How long after its handling a fault can still be the cause of others: bad data need a few periods
/// to travel through a few components, and the slowest of a robot run at a few Hz; a fault that comes
/// later has had good data in between.
pub(crate) const CORRELATION_WINDOW: Duration = Duration::from_secs(1);

impl FaultManager {
    /// Decides about a confirmed fault. An emergency stop comes before all questions. A consequence
    /// starts nothing of its own; if its component is in ERROR it waits until its cause has been
    /// handled, and is then judged anew.
    pub(crate) fn diagnose(&mut self, id: FaultId) {
        let cause = self.cause(id);
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        if let Some(root) = cause {
            fault.verdict.cause = Cause::ConsequenceOf(root);
        }
        if fault.terms.severity == ComponentSeverity::Emergency {
            self.raise_emergency(id);
            return;
        }
        let state = &self.components[fault.component];
        let taken_care_of = state.down.is_some() || state.recovery().is_some();
        match cause {
            None => self.decide(id),
            Some(root) if !fault.runs && !taken_care_of => fault.waits = Some(Wait::Root(root)),
            Some(_) => self.finish(id),
        }
    }

    /// A consequence has shown another symptom: its cause may be over by now.
    pub(crate) fn doubt(&mut self, id: FaultId) {
        let explained = self.explain(id);
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        match explained {
            Some(root) if !fault.runs => {
                fault.verdict.cause = Cause::ConsequenceOf(root);
                fault.waits = Some(Wait::Root(root));
                self.changed.insert(id);
            }
            Some(_) => {}
            None => self.judge_anew(id),
        }
    }

    /// Judges the trouble of a fault as a fault of its own, which a consequence never becomes: it
    /// is closed and refers to the new one. What an operator has let go on after an emergency stop
    /// is recovered, not stopped again.
    pub(crate) fn judge_anew(&mut self, id: FaultId) {
        let number = self.history.number();
        let Some(old) = self.history.get(id) else {
            return;
        };
        let mut new = old.anew(number);
        if new.terms.severity == ComponentSeverity::Emergency {
            new.terms.severity = ComponentSeverity::Reset;
            new.verdict.severity = Severity::Reset;
        }
        self.history.insert(new);
        self.plan(id, wording::judged_anew(number));
        self.give_up_waiting(id);
        self.set_state(id, FaultState::Cleared);
        self.changed.insert(number);
        self.diagnose(number);
    }

    /// Nothing more is done for a fault; what waits for that is judged by [`Self::settle`].
    pub(crate) fn finish(&mut self, id: FaultId) {
        let now = self.now;
        if let Some(fault) = self.history.get_mut(id) {
            fault.finish(now);
            self.changed.insert(id);
            self.finished.push_back(id);
        }
    }

    /// A fault does not wait any more, and nothing is done for it.
    pub(crate) fn give_up_waiting(&mut self, id: FaultId) {
        if let Some(fault) = self.history.get_mut(id) {
            fault.waits = None;
            self.finish(id);
        }
    }

    /// Judges consequences whose causes have been handled and that are still in ERROR.
    pub(crate) fn settle(&mut self) {
        while let Some(root) = self.finished.pop_front() {
            if self.history.get(root).is_some_and(Fault::is_being_handled) {
                continue;
            }
            let waiting = Some(Wait::Root(root));
            for id in self.history.which(|fault| fault.waits == waiting) {
                self.judge_anew(id);
            }
        }
    }

    /// What else is to blame: what took the component down, the recovery that it is in, or something
    /// upstream.
    fn cause(&self, id: FaultId) -> Option<FaultId> {
        let fault = self.history.get(id)?;
        let state = &self.components[fault.component];
        if let Some(down) = state.down.filter(|down| down.by != id) {
            return Some(self.root_of(down.by));
        }
        if let Some(work) = state.recovery()
            && work.fault != id
            && fault.terms.severity != ComponentSeverity::Stop
        {
            return Some(self.root_of(work.fault));
        }
        self.explain(id)
    }

    /// The fault of something upstream that explains this one: the nearest, and of those one that is
    /// not over before one that is, and the oldest.
    fn explain(&self, id: FaultId) -> Option<FaultId> {
        let fault = self.history.get(id)?;
        let mut suspects = self.suspects(fault.runs);
        suspects.retain(|(_, root)| *root != id);
        if suspects.is_empty() {
            return None;
        }
        let is_over = |root: FaultId| {
            let state = self.history.get(root).map(|fault| fault.verdict.state);
            state != Some(FaultState::Confirmed)
        };
        let port = self.input_port(fault.component, &self.detectors.all[fault.detector.0].kind);
        let upstream = self.graph.upstream(fault.component, port);
        for steps in upstream.chunk_by(|one, other| one.0 == other.0) {
            let near = |component: usize| steps.iter().any(|(_, step)| *step == component);
            let roots = suspects
                .iter()
                .filter(|(component, _)| near(*component))
                .map(|(_, root)| *root);
            if let Some(root) = roots.min_by_key(|root| (is_over(*root), *root)) {
                return Some(root);
            }
        }
        None
    }

    /// Components that may send nothing or nonsense, each with the root cause of it. A fault that has
    /// been handled explains only those that run: one in ERROR is not left there because of it.
    fn suspects(&self, runs: bool) -> Vec<(usize, FaultId)> {
        let now = self.now;
        let recent = |at: Duration| runs && at.saturating_add(CORRELATION_WINDOW) > now;
        let explains = |root: FaultId| {
            self.history.get(root).is_some_and(|fault| {
                fault.verdict.state != FaultState::Prefailed
                    && (fault.is_being_handled() || fault.handled_at.is_some_and(recent))
            })
        };
        let suspect = |fault: &Fault| {
            let root = self.root_of(fault.verdict.id);
            explains(root).then_some((fault.component, root))
        };
        let mut suspects: Vec<(usize, FaultId)> = if runs {
            self.history.all().filter_map(suspect).collect()
        } else {
            self.history.open().filter_map(suspect).collect()
        };
        if runs {
            let states = self.components.iter().enumerate();
            let down = states.filter_map(|(component, state)| Some((component, state.down?.by)));
            suspects.extend(down.map(|(component, by)| (component, self.root_of(by))));
        }
        suspects
    }

    fn root_of(&self, id: FaultId) -> FaultId {
        match self.history.get(id).map(|fault| fault.verdict.cause) {
            Some(Cause::ConsequenceOf(root)) => root,
            Some(Cause::Root) | None => id,
        }
    }

    /// The input port whose data a detector looks at.
    fn input_port(&self, component: usize, kind: &DetectorKind) -> Option<&str> {
        let (DetectorKind::Validity { port, .. }
        | DetectorKind::Freshness { port }
        | DetectorKind::RateOfChange { port, .. }
        | DetectorKind::Stuck { port, .. }) = kind
        else {
            return None;
        };
        let rules: &PortRules = self.system.components[component].rules.ports.get(*port)?;
        (rules.direction == PortDirection::Input).then_some(rules.port.as_str())
    }
}
