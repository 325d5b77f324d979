//! The container's stand-in: what happens in which order is as in a container in simulated time, but
//! a cycle does nothing but read and send.

mod data;
mod looks;
mod misfortune;
mod models;
mod orders;
mod time;
mod work;

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use system_model::specification::{ExecutionKind, ExecutionSemantics};

use self::data::Wiring;
use self::looks::Looks;
use self::misfortune::Misfortune;
use self::models::Model;
use self::orders::Order;
use self::work::Executor;
use super::answer::{self, Answer};
use super::{Assumptions, Supposition};
use crate::manager::FaultManager;
use crate::observation::Observation;
use crate::plan::ActionId;
use crate::system::Scope;
use crate::verdict::{FaultId, Verdict};

/// When the fault begins, by the clock of the stand-in: every component has worked for a while, and
/// every watch has begun.
pub const BEGIN: Duration = Duration::from_secs(1);

/// The least time in which nothing more is done until the answer is complete; see [`patience`].
const LEAST_PATIENCE: Duration = Duration::from_secs(2);

/// The answer is what has been done by then: a budget of 100 resets with pauses of seconds is used
/// up within it.
const LONGEST: Duration = Duration::from_secs(600);

/// In simulated time a cycle of an executor without a period takes this long.
const APERIODIC_CYCLE: Duration = Duration::from_micros(1);

/// The container without a robot.
pub(super) struct StandIn<'a> {
    scopes: &'a [Scope],
    manager: FaultManager,
    now: Duration,
    components: Vec<Component>,
    /// By priority, then by name: the order among those that are due at the same time.
    executors: Vec<Executor>,
    wiring: Wiring,
    models: Vec<Model>,
    looks: Looks,
    misfortune: Misfortune,
    assumptions: &'a Assumptions,
    observations: VecDeque<Observation>,
    /// What can be observed only later.
    matures: Vec<(Duration, Observation)>,
    /// Orders whose time has not come.
    later: Vec<(Duration, Order)>,
    /// The emergency stop under way, and how many actuators have not answered.
    emergency: Option<(ActionId, usize)>,
    verdicts: BTreeMap<FaultId, Verdict>,
    /// When something was last done or decided.
    last_change: Duration,
}

/// Where a component stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    Active,
    Inactive,
    Error,
    Destroyed,
}

impl State {
    /// Its name in summaries.
    pub fn name(self) -> &'static str {
        match self {
            Self::Active => "ACTIVE",
            Self::Inactive => "INACTIVE",
            Self::Error => "ERROR",
            Self::Destroyed => "DESTROYED",
        }
    }
}

/// A component that does nothing but complete its cycles.
#[derive(Debug)]
pub(super) struct Component {
    pub name: String,
    pub application: usize,
    pub state: State,
    pub incarnation: u32,
    execution: ExecutionSemantics,
    /// After how long a callback of it is a hang.
    hang_after: Duration,
    cycles: u64,
    overruns: u64,
    /// Recovered, and no cycle completed since.
    unproven: bool,
    /// It hangs and will be broken off then.
    hanging_until: Duration,
    /// The secondary that has taken its place.
    secondary: Option<usize>,
}

impl<'a> StandIn<'a> {
    pub fn new(
        scopes: &'a [Scope],
        supposition: &Supposition,
        assumptions: &'a Assumptions,
    ) -> Self {
        let manager = FaultManager::new(scopes.to_vec());
        let mut components = Vec::new();
        let mut firsts = Vec::new();
        for (application, scope) in scopes.iter().enumerate() {
            firsts.push(components.len());
            let all = scope.specification.components.iter().enumerate();
            components.extend(all.map(|(index, specification)| {
                Component {
                    name: specification.name.clone(),
                    application,
                    state: State::Active,
                    incarnation: 1,
                    execution: specification.execution,
                    hang_after: (scope.rules.components.get(index))
                        .map(|rules| rules.watchdog_deadline(&specification.execution))
                        .unwrap_or_default(),
                    cycles: 0,
                    overruns: 0,
                    unproven: false,
                    hanging_until: Duration::ZERO,
                    secondary: None,
                }
            }));
        }
        let wiring = Wiring::new(scopes, &firsts, &manager, assumptions);
        let models = models::models(scopes, &firsts, &manager);
        Self {
            scopes,
            executors: work::executors(&manager, &components),
            looks: Looks::new(&manager, scopes),
            misfortune: Misfortune::new(supposition, firsts[supposition.application], scopes),
            wiring,
            models,
            manager,
            now: Duration::ZERO,
            components,
            assumptions,
            observations: VecDeque::from([Observation::Running]),
            matures: Vec::new(),
            later: Vec::new(),
            emergency: None,
            verdicts: BTreeMap::new(),
            last_change: Duration::ZERO,
        }
    }

    /// Lets time pass until nothing more is done.
    pub fn run(mut self) -> Answer {
        let patience = patience(self.scopes);
        loop {
            self.serve();
            let next = self.next_executor();
            let tick = self.tick_due();
            let ends = self.last_change.max(BEGIN).saturating_add(patience);
            let time = next.map_or(tick, |(due, _)| due.min(tick));
            if time > ends.min(LONGEST) && !self.is_waiting() || time > LONGEST {
                break;
            }
            self.now = self.now.max(time);
            match next {
                Some((due, executor)) if due < tick => self.run_executor(executor),
                _ => self.tick(),
            }
        }
        self.power_off_actuators();
        answer::conclude(self.answered())
    }

    /// Whether something is still to come of what was begun.
    fn is_waiting(&self) -> bool {
        let under_way = self.manager.components.iter();
        under_way.clone().any(|state| state.work.is_some()) || !self.later.is_empty()
    }

    fn answered(self) -> answer::Course {
        answer::Course {
            applications: (self.scopes.iter())
                .map(|scope| scope.specification.name.clone())
                .collect(),
            conditions: (0..self.components.len())
                .filter_map(|index| self.manager.condition(index))
                .collect(),
            emergency: self.manager.is_emergency(),
            reaches: self.misfortune.readers(&self.components),
            components: self.components,
            verdicts: self.verdicts.into_values().collect(),
        }
    }

    fn observe(&mut self, observation: Observation) {
        self.observations.push_back(observation);
    }
}

impl Component {
    fn is_passive(&self) -> bool {
        self.execution.kind == ExecutionKind::Passive
    }
}

/// How long nothing must be done until nothing more will be: twice the longest time that any rule
/// waits for something.
fn patience(scopes: &[Scope]) -> Duration {
    let rules = scopes.iter().flat_map(|scope| &scope.rules.components);
    let times = rules.flat_map(|rules| {
        let ports = rules
            .ports
            .iter()
            .filter_map(|port| port.checks.freshness.as_ref());
        let fresh = ports.map(|rule| rule.value.maximum_age);
        let beats = rules.heartbeat.iter();
        let beats = beats.map(|rule| rule.value.period.saturating_mul(rule.value.missed));
        let overruns = rules.overrun.iter().map(|rule| rule.value.within);
        fresh.chain(beats).chain(overruns).collect::<Vec<_>>()
    });
    let longest = times.max().unwrap_or_default();
    LEAST_PATIENCE.max(longest.saturating_mul(2))
}
