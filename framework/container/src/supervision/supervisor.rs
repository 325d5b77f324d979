//! The thin shell around the fault manager: observations go in, effects are carried out.
//!
//! Whoever has observed something calls [`Supervisor::attend`] afterwards; nobody waits: if another
//! thread is at it, that one or the thread that looks after time sees the observation too. What is
//! to be done with a component is an order to its executor.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use crossbeam::channel::{Receiver, Sender, bounded};
use fault_manager::{Effect, FaultId, FaultManager, Observation, Verdict};
use system_model::fault::FaultKind;
use system_model::specification::ManagerPort;

use super::emergency::Emergency;
use super::orders::{Order, Orders};
use super::standby::Standbys;
use super::{ManagerOutputs, Monitors};
use crate::clock::nanoseconds;
use crate::component::Environment;
use crate::event_log::Event;
use crate::guard::loss::Loss;
use crate::status::ComponentStatus;
use crate::wake::Wake;

/// Verdicts whose decision was timed; older ones are not recorded any more.
const MOST_DECISIONS: usize = 256;

/// The shell.
pub struct Supervisor {
    pub(super) environment: Arc<Environment>,
    core: Mutex<Core>,
    /// By component: who runs it.
    pub(super) orders: Vec<Arc<Orders>>,
    standbys: Vec<Standbys>,
    pub(super) statuses: Vec<Arc<ComponentStatus>>,
    pub(super) emergency: Emergency,
    pub(super) monitors: Mutex<Monitors>,
    /// Wakes the thread that looks after time.
    pub(super) wake: Wake,
    /// When that one looks again, in nanoseconds.
    pub(super) looks_again_ns: AtomicU64,
    /// When injections were looked at last, in nanoseconds.
    pub(super) injected_ns: AtomicU64,
    /// Components of which a standby was used, for the thread that prepares another.
    wanted: Sender<usize>,
}

pub(super) struct Core {
    pub(super) manager: FaultManager,
    /// Orders whose time has not come.
    pub(super) later: Vec<(u64, Order)>,
    /// How long decisions took, by fault, in microseconds.
    decisions: VecDeque<(FaultId, u64)>,
    pub(super) outputs: ManagerOutputs,
    /// How long the last decision took.
    took: Duration,
    /// How many verdicts have been put on record.
    pub(super) recorded: u64,
}

impl Core {
    /// When the fault manager, or an order, wants the next tick, in nanoseconds.
    pub(super) fn due_ns(&self) -> Option<u64> {
        let later = self.later.iter().map(|(time_ns, _)| *time_ns).min();
        let manager = self.manager.due().map(nanoseconds);
        later.into_iter().chain(manager).min()
    }

    /// How long the decision about a fault took, if it was timed.
    fn decision_us(&self, id: FaultId) -> Option<u64> {
        let known = self.decisions.iter().find(|(known, _)| *known == id)?;
        Some(known.1)
    }

    fn time_decision(&mut self, id: FaultId, took: Duration) -> u64 {
        if self.decisions.len() >= MOST_DECISIONS {
            self.decisions.pop_front();
        }
        let took_us = u64::try_from(took.as_micros()).unwrap_or(u64::MAX);
        self.decisions.push_back((id, took_us));
        took_us
    }
}

impl Supervisor {
    /// A shell around `manager` for components whose executors take orders by `orders`.
    pub fn new(
        environment: Arc<Environment>,
        manager: FaultManager,
        orders: Vec<Arc<Orders>>,
        standbys: Vec<Standbys>,
        statuses: Vec<Arc<ComponentStatus>>,
        emergency: Emergency,
        monitors: Monitors,
    ) -> (Self, Receiver<usize>) {
        let (wanted, wants) = bounded(standbys.len().max(1));
        let supervisor = Self {
            environment,
            core: Mutex::new(Core {
                manager,
                later: Vec::new(),
                decisions: VecDeque::new(),
                outputs: ManagerOutputs::default(),
                took: Duration::ZERO,
                recorded: 0,
            }),
            orders,
            standbys,
            statuses,
            emergency,
            monitors: Mutex::new(monitors),
            wake: Wake::default(),
            looks_again_ns: AtomicU64::new(u64::MAX),
            injected_ns: AtomicU64::new(0),
            wanted,
        };
        (supervisor, wants)
    }

    /// Prepares all standbys of a component that the rules want and are not there.
    ///
    /// # Errors
    /// Which one could not be prepared, and why; then it is made when it is needed.
    pub fn prepare_standbys(&self, component: usize, loss: &Loss) -> Result<(), String> {
        let Some(standbys) = self.standbys.get(component) else {
            return Ok(());
        };
        standbys.free_retired();
        let mut failure = Ok(());
        for variant in standbys.wanting() {
            if let Err(reason) = standbys.prepare(variant, loss) {
                let name = &standbys.factory().variants()[variant].specification;
                failure = Err(format!(
                    "no standby '{}' for '{}' could be prepared: {reason}",
                    name.type_name, name.name
                ));
            }
        }
        failure
    }

    /// Asks the thread that prepares standbys for what is missing.
    pub fn want_standbys(&self, component: usize) {
        // Full only if every component is on it already: then this one is looked at, too.
        let _on_it = self.wanted.try_send(component);
    }

    /// What all components share.
    pub fn environment(&self) -> &Arc<Environment> {
        &self.environment
    }

    /// The standbys of a component.
    pub fn standbys(&self, component: usize) -> Option<&Standbys> {
        self.standbys.get(component)
    }

    /// The emergency stop.
    pub fn emergency(&self) -> &Emergency {
        &self.emergency
    }

    /// Lets the fault manager see what was observed, if anything was.
    #[inline]
    pub fn attend(&self) {
        if self.environment.observations.is_pending() {
            self.process();
        }
    }

    /// Leaves an observation and lets the fault manager see it.
    pub fn observe(&self, observation: Observation) {
        self.environment.observations.report(observation);
        self.process();
    }

    /// The verdicts on record, oldest first.
    pub fn verdicts(&self) -> Vec<Verdict> {
        let core = self.lock();
        let mut verdicts: Vec<Verdict> = core.manager.verdicts().cloned().collect();
        for verdict in &mut verdicts {
            self.environment.scenes.complete(verdict);
            verdict.decision_us += core.decision_us(verdict.id).unwrap_or_default();
        }
        verdicts
    }

    /// Puts the verdicts on record again whose backtraces were found since the last time.
    pub fn record_backtraces(&self) {
        while let Some((component, incarnation)) = self.environment.scenes.take_found() {
            let mut core = self.lock();
            let verdicts = core.manager.verdicts();
            let of_it = verdicts
                .filter(|it| (it.component == component) && it.incarnation == incarnation)
                .last()
                .cloned();
            if let Some(verdict) = of_it {
                let now_ns = self.environment.clock.now_ns();
                self.record(&mut core, verdict, Duration::ZERO, now_ns);
            }
        }
    }

    /// Whether the emergency stop is latched.
    pub fn is_emergency(&self) -> bool {
        self.lock().manager.is_emergency()
    }

    fn process(&self) {
        while self.environment.observations.is_pending() {
            let mut core = match self.core.try_lock() {
                Ok(core) => core,
                Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
                // Whoever is at it may only be reading: the thread that looks after time looks again.
                Err(TryLockError::WouldBlock) => return self.rouse(),
            };
            let simulated = self.environment.clock.is_simulated();
            self.write_records(&mut core);
            let mut urgent = false;
            while let Some(observation) = self.environment.observations.take() {
                let now = self.environment.clock.now();
                let start = Instant::now();
                let effects = core.manager.react(now, observation);
                if !simulated {
                    core.took = start.elapsed();
                }
                for effect in effects {
                    urgent |= matches!(&effect, Effect::Act(planned) if planned.not_before <= now);
                    self.carry_out(&mut core, effect);
                }
                if simulated {
                    // Nobody waits, and the record tells everything in its order.
                    self.write_records(&mut core);
                }
            }
            if !urgent {
                self.write_records(&mut core);
            }
            let due_ns = core.due_ns();
            drop(core);
            if due_ns.is_some_and(|due_ns| due_ns < self.looks_again_ns.load(Ordering::SeqCst)) {
                self.rouse();
            }
        }
    }

    /// Puts the verdicts on record that have changed.
    pub(super) fn write_records(&self, core: &mut Core) {
        let (at_ns, took) = (self.environment.clock.now_ns(), core.took);
        let changed: Vec<Box<Verdict>> = core.manager.records().collect();
        for verdict in changed {
            self.record(core, *verdict, took, at_ns);
        }
    }

    fn record(&self, core: &mut Core, mut verdict: Verdict, took: Duration, at_ns: u64) {
        self.environment.scenes.complete(&mut verdict);
        core.recorded += 1;
        let known = core.decision_us(verdict.id);
        if known.is_none() && verdict.kind != FaultKind::OperatorOrder.name() {
            // An order is no fault. A verdict is recorded first when its fault is confirmed, and changes again only while
            // its decision is remembered, but for one that is very old.
            self.raise(core, ManagerPort::Fault);
        }
        verdict.decision_us += known.unwrap_or_else(|| core.time_decision(verdict.id, took));
        let event = Event::Verdict(Box::new(verdict));
        self.environment.events.record(at_ns, event);
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Core> {
        self.core.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
