//! What the leaves of one tree can do with the running system.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use fault_manager::{Condition, DetectorKind, Evidence, Observation, OperatorOrder, Symptom};
use system_model::fault::FaultKind;
use system_model::life_cycle::LifeCycleState;

use crate::event_log::Event;
use crate::supervision::Supervisor;

/// The way from the leaves of a tree to components.
pub struct Reach {
    supervisor: Arc<Supervisor>,
    /// The tree's name, and its index behind all components.
    name: String,
    tree: usize,
    /// Components that nobody runs any more, and when they are stopped at the latest.
    leaving: Mutex<Vec<(usize, Duration)>>,
}

impl Reach {
    /// For the leaves of a tree.
    pub fn new(supervisor: Arc<Supervisor>, name: String, tree: usize) -> Self {
        Self {
            supervisor,
            name,
            tree,
            leaving: Mutex::default(),
        }
    }

    /// The tree's index behind all components.
    pub fn tree(&self) -> usize {
        self.tree
    }

    /// Who carries out what is asked.
    pub fn supervisor(&self) -> &Arc<Supervisor> {
        &self.supervisor
    }

    pub(super) fn works(&self, component: usize) -> bool {
        self.supervisor.works(component)
    }

    pub(super) fn condition(&self, component: usize) -> Condition {
        self.supervisor.condition(component)
    }

    pub(super) fn state(&self, component: usize) -> Option<LifeCycleState> {
        self.supervisor.state(component)
    }

    pub(super) fn incarnation(&self, component: usize) -> u32 {
        self.supervisor.incarnation(component)
    }

    /// Has something done with a component; an error says why it makes no sense now.
    pub(super) fn order(&self, component: usize, order: OperatorOrder) -> Result<(), String> {
        self.supervisor.order_by_tree(self.tree, component, order)
    }

    /// The container's clock.
    pub(super) fn now_ns(&self) -> u64 {
        self.supervisor.environment().clock.now_ns()
    }

    /// Puts on record what a person should know.
    pub(super) fn notice(&self, message: &str) {
        let environment = self.supervisor.environment();
        let message = format!("tree '{}': {message}", self.name);
        let event = Event::Notice { message };
        environment.events.record(environment.clock.now_ns(), event);
    }

    /// Reports a fault of a component, or of the tree itself.
    pub(super) fn raise(&self, subject: usize, message: String) {
        let kind = DetectorKind::FaultEvent(None);
        let evidence = seen_in_a_tick(message);
        let incarnation = self.incarnation(subject).max(1);
        let symptom = (FaultKind::Reported, true, incarnation);
        self.report(subject, &kind, symptom, evidence);
    }

    /// The tree itself has failed.
    pub(super) fn fail(&self, kind: FaultKind, message: String, incarnation: u32) {
        let evidence = seen_in_a_tick(message);
        let symptom = (kind, false, incarnation);
        self.report(self.tree, &DetectorKind::Exception, symptom, evidence);
    }

    fn report(
        &self,
        subject: usize,
        detector: &DetectorKind,
        (kind, runs, incarnation): (FaultKind, bool, u32),
        evidence: Evidence,
    ) {
        let Some(detector) = self.supervisor.detector(subject, detector) else {
            return;
        };
        let symptom = Symptom {
            detector,
            incarnation,
            kind,
            return_code: 0,
            at: Duration::from_nanos(self.now_ns()),
            runs,
            evidence,
        };
        self.supervisor
            .observe(Observation::Symptom(Box::new(symptom)));
    }

    /// Nobody runs a component any more: it is stopped when another one has taken over, at the latest
    /// at `until`.
    pub(super) fn leave(&self, component: usize, until: Duration) {
        self.leaving().push((component, until));
    }

    /// A component that was to be stopped is wanted again.
    pub(super) fn stay(&self, component: usize) {
        self.leaving().retain(|(other, _)| *other != component);
    }

    /// Another component has taken over: who still goes on is stopped.
    pub(super) fn taken_over(&self) {
        self.stop_leaving(|_until| true);
    }

    /// Stops those whose time is over.
    pub(super) fn expire(&self, now: Duration) {
        self.stop_leaving(|until| until <= now);
    }

    fn stop_leaving(&self, is_due: impl Fn(Duration) -> bool) {
        let mut leaving = self.leaving();
        if leaving.is_empty() {
            return;
        }
        // One that cannot be stopped now is stopped later.
        leaving.retain(|(component, until)| {
            let is_down = matches!(
                self.condition(*component),
                Condition::Stopped | Condition::Destroyed | Condition::Lost
            );
            let is_stopped = || self.order(*component, OperatorOrder::Stop).is_ok();
            !is_down && (!is_due(*until) || !is_stopped())
        });
    }

    fn leaving(&self) -> MutexGuard<'_, Vec<(usize, Duration)>> {
        self.leaving.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn seen_in_a_tick(message: String) -> Evidence {
    Evidence::Exception {
        callback: "tick".to_owned(),
        message,
        place: None,
        signal: None,
        address: None,
        backtrace: Vec::new(),
        thread_lost: false,
        damage: None,
    }
}
