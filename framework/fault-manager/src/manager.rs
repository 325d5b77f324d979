//! The face of the fault manager: observations in, effects out.

use std::collections::{BTreeSet, VecDeque};
use std::time::Duration;

use system_model::fault::FaultKind;

use crate::detectors::Detectors;
use crate::emergency::Emergency;
use crate::graph::{Graph, Level};
use crate::handling_by_tree::HandledByTree;
use crate::history::History;
use crate::life::Fault;
use crate::observation::{Detector, DetectorId, DetectorKind, Observation};
use crate::plan::Effect;
use crate::state::{ComponentState, Condition};
use crate::system::{Scope, System};
use crate::verdict::{FaultId, FaultState, Verdict};

/// Detection, diagnosis and recovery planning for all applications of a container.
///
/// A pure state machine: what it does depends on the scopes, the observations and their times alone,
/// and the same sequence always has the same effects. It answers every observation at once and has a
/// bound for everything it keeps.
#[derive(Debug)]
pub struct FaultManager {
    pub(crate) system: System,
    pub(crate) graph: Graph,
    pub(crate) detectors: Detectors,
    pub(crate) history: History,
    pub(crate) components: Vec<ComponentState>,
    pub(crate) emergency: Option<Emergency>,
    /// What trees are handling.
    pub(crate) handled: Vec<HandledByTree>,
    pub(crate) running: bool,
    /// The latest time that was told.
    pub(crate) now: Duration,
    pub(crate) last_action: u64,
    /// Effects of the observation at hand.
    pub(crate) effects: Vec<Effect>,
    /// Faults whose verdicts have changed by the observation at hand.
    pub(crate) changed: BTreeSet<FaultId>,
    /// Faults whose handling has ended by the observation at hand: others may wait for that.
    pub(crate) finished: VecDeque<FaultId>,
}

impl FaultManager {
    /// For the applications of one container. Indices of components count through all of them, one
    /// application after the other.
    pub fn new(applications: Vec<Scope>) -> Self {
        let system = System::new(&applications);
        Self {
            graph: Graph::new(&applications, &system),
            detectors: Detectors::new(&applications, &system),
            history: History::new(),
            components: system
                .components
                .iter()
                .map(|_| ComponentState::default())
                .collect(),
            emergency: None,
            handled: Vec::new(),
            running: false,
            now: Duration::ZERO,
            last_action: 0,
            effects: Vec::new(),
            changed: BTreeSet::new(),
            finished: VecDeque::new(),
            system,
        }
    }

    /// Everything that can raise symptoms, as rules and defaults have it; [`DetectorId`] is the
    /// index. Every component has one for runtime exceptions, for hangs and for what it reports.
    /// `overrun` and `heartbeat` come from the narrowest rule: the component's own, else that of its
    /// executor, its application, its node; the latter two only for components that work in periods.
    pub fn detectors(&self) -> &[Detector] {
        &self.detectors.all
    }

    /// The detector of a component, if there is one. `component` is the component to blame.
    pub fn detector(&self, component: usize, kind: &DetectorKind) -> Option<DetectorId> {
        self.detectors.find(component, kind)
    }

    /// Takes an observation in, made at `now` by the clock of the applications. A time before an
    /// earlier one counts as that. Detectors, actions and components that do not exist are ignored.
    ///
    /// Actions come before the records that tell of them, so that nothing waits for a record; a
    /// verdict that changes several times by one observation is recorded once.
    pub fn observe(&mut self, now: Duration, observation: Observation) -> Vec<Effect> {
        let mut effects = self.react(now, observation);
        effects.extend(self.records().map(Effect::Record));
        effects
    }

    /// As [`Self::observe`], for who is in a hurry: the verdicts that have changed are to be asked
    /// for afterwards ([`Self::records`]); one that changes again before that is recorded once.
    pub fn react(&mut self, now: Duration, observation: Observation) -> Vec<Effect> {
        let before = self.now.max(now);
        self.now = before;
        // What was due earlier comes first; what is due just now leaves the observation the lead.
        self.elapse(|due| due < before);
        let hurried = matches!(observation, Observation::Symptom(_));
        match observation {
            Observation::Running => self.run(),
            Observation::Symptom(symptom) => self.symptom(*symptom),
            Observation::Passed(detector) => self.passed(detector),
            Observation::Ended { action, outcome } => self.ended(action, outcome),
            Observation::Works {
                component,
                incarnation,
            } => self.works(component, incarnation),
            Observation::Clear(None) => self.clear_all(),
            Observation::Clear(Some(id)) => self.clear(id),
            Observation::Ordered { component, order } => self.ordered(component, order, None),
            Observation::OrderedByTree {
                tree,
                component,
                order,
            } => self.ordered(component, order, Some(tree)),
            Observation::Tick => {}
        }
        self.elapse(|due| due <= before);
        self.history.tidy(hurried);
        std::mem::take(&mut self.effects)
    }

    /// When the next [`Observation::Tick`] is wanted at the latest: the deadline of an action, or
    /// the end of a debounce or of the quiet time after a fault. `not_before` of an action is the
    /// container's own matter.
    pub fn due(&self) -> Option<Duration> {
        let actions = self.components.iter().flat_map(|state| &state.work);
        let actions = actions.map(|work| work.deadline).min();
        let emergency = self.emergency.as_ref().and_then(Emergency::deadline);
        let lives = self.history.earliest(|fault| self.life_due(fault));
        [actions, emergency, lives, self.tree_due()]
            .into_iter()
            .flatten()
            .min()
    }

    /// All faults that are not cleared, and the last of those that are, oldest first.
    pub fn verdicts(&self) -> impl Iterator<Item = &Verdict> {
        self.history.all().map(|fault| &fault.verdict)
    }

    /// The verdict on a fault, unless it has been forgotten.
    pub fn verdict(&self, id: FaultId) -> Option<&Verdict> {
        self.history.get(id).map(|fault| &fault.verdict)
    }

    /// Whether an emergency stop is latched.
    pub fn is_emergency(&self) -> bool {
        self.emergency.is_some()
    }

    /// How a component is doing; `None` for an index that no component has.
    pub fn condition(&self, component: usize) -> Option<Condition> {
        let state = self.components.get(component)?;
        let waits = || {
            self.history
                .open()
                .any(|fault| fault.component == component && fault.waits.is_some() && !fault.runs)
        };
        Some(match &state.down {
            Some(down) => down.condition,
            None if state.work.is_some() => Condition::Recovering,
            None if waits() => Condition::Waiting,
            None => Condition::Working,
        })
    }

    /// How many faults of a component are confirmed and not healed; orders of an operator are none.
    pub fn open_faults(&self, component: usize) -> usize {
        self.present_faults(component, None).count()
    }

    /// The faults of a component, of a kind if one is named, that are confirmed and not healed; orders
    /// are none.
    pub fn present_faults<'a>(
        &'a self,
        component: usize,
        kind: Option<&'a str>,
    ) -> impl Iterator<Item = FaultId> + 'a {
        let is_present = move |fault: &&Fault| {
            fault.component == component
                && fault.verdict.state == FaultState::Confirmed
                && fault.kind != FaultKind::OperatorOrder
                && kind.is_none_or(|kind| fault.verdict.kind == kind)
        };
        let open = self.history.open().filter(is_present);
        open.map(|fault| fault.verdict.id)
    }

    /// The verdict on what an operator ordered last for a component, unless it has been forgotten.
    pub fn newest_order(&self, component: usize) -> Option<FaultId> {
        let ordered =
            |fault: &&Fault| fault.component == component && fault.kind == FaultKind::OperatorOrder;
        let newest = self.history.all().filter(ordered).last();
        newest.map(|fault| fault.verdict.id)
    }

    /// How far each component is down at the moment.
    pub(crate) fn levels(&self) -> Vec<Level> {
        let level = |state: &ComponentState| state.down.map_or(Level::Up, |down| down.level());
        self.components.iter().map(level).collect()
    }

    /// The verdicts that have changed since they were asked for last, for the record.
    pub fn records(&mut self) -> impl Iterator<Item = Box<Verdict>> {
        let changed = std::mem::take(&mut self.changed).into_iter();
        changed.filter_map(|id| {
            let fault = self.history.get(id)?;
            Some(Box::new(fault.verdict.clone()))
        })
    }
}
