//! The thin shell around the fault manager: observations go in, effects are carried out.
//!
//! Whoever has observed something calls [`Supervisor::attend`] afterwards; nobody waits: if another
//! thread is at it, that thread sees the observation too. What is to be done with a component is an
//! order to its executor.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use crossbeam::channel::{Receiver, Sender, bounded};
use fault_manager::{
    Action, ActionId, ActionOutcome, Effect, Evidence, FaultId, FaultManager, Observation,
    PlannedAction, Verdict,
};

use system_model::specification::ManagerPort;

use super::emergency::Emergency;
use super::orders::{Order, Orders, Task};
use super::standby::Standbys;
use super::{LOOK_PERIOD, ManagerOutputs, Monitors};
use crate::component::Environment;
use crate::event_log::Event;
use crate::guard::loss::Loss;
use crate::status::ComponentStatus;
use crate::wake::Wake;

/// Verdicts whose decision was timed; older ones are not recorded any more.
const MOST_DECISIONS: usize = 256;

/// The shell.
pub struct Supervisor {
    environment: Arc<Environment>,
    core: Mutex<Core>,
    /// By component: who runs it.
    orders: Vec<Arc<Orders>>,
    standbys: Vec<Standbys>,
    statuses: Vec<Arc<ComponentStatus>>,
    emergency: Emergency,
    monitors: Mutex<Monitors>,
    /// Wakes the thread that looks after time.
    wake: Wake,
    /// When injections were looked at last, in nanoseconds.
    injected_ns: AtomicU64,
    /// Components of which a standby was used, for the thread that prepares another.
    wanted: Sender<usize>,
}

struct Core {
    manager: FaultManager,
    /// Orders whose time has not come.
    later: Vec<(u64, Order)>,
    /// How long decisions took, by fault, in microseconds.
    decisions: VecDeque<(FaultId, u64)>,
    outputs: ManagerOutputs,
}

impl Core {
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
            }),
            orders,
            standbys,
            statuses,
            emergency,
            monitors: Mutex::new(monitors),
            wake: Wake::default(),
            injected_ns: AtomicU64::new(0),
            wanted,
        };
        (supervisor, wants)
    }

    /// These components hear what the fault manager raises.
    pub fn set_outputs(&self, outputs: ManagerOutputs) {
        self.lock().outputs = outputs;
    }

    fn raise(&self, core: &mut Core, port: ManagerPort) {
        let now_ns = self.environment.clock.now_ns();
        for deaf in core.outputs.raise(port, now_ns) {
            self.notice(&format!(
                "'{deaf}' takes no events of the fault manager: '{}' is lost to it",
                port.name()
            ));
        }
    }

    /// Prepares all standbys of a component that the rules want and are not there. One that cannot
    /// be prepared is made when it is needed.
    pub fn prepare_standbys(&self, component: usize, loss: &Loss) {
        let Some(standbys) = self.standbys.get(component) else {
            return;
        };
        for variant in standbys.wanting() {
            if let Err(reason) = standbys.prepare(variant, loss) {
                let name = &standbys.factory().variants()[variant].specification;
                self.notice(&format!(
                    "no standby '{}' for '{}' could be prepared: {reason}",
                    name.type_name, name.name
                ));
            }
        }
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

    /// What time brings: orders that are due, deadlines of the fault manager.
    pub fn tick(&self) {
        let now_ns = self.environment.clock.now_ns();
        self.environment
            .observations
            .mature(now_ns, |observation| self.is_of_now(observation));
        self.inject(now_ns);
        self.monitors
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .look(Duration::from_nanos(now_ns), &self.environment.observations);
        let (due, wants_tick) = {
            let mut core = self.lock();
            let mut due = Vec::new();
            core.later.retain(|(time_ns, order)| {
                let is_due = *time_ns <= now_ns;
                if is_due {
                    due.push(order.clone());
                }
                !is_due
            });
            let wants_tick = core
                .manager
                .due()
                .is_some_and(|due| nanoseconds(due) <= now_ns);
            (due, wants_tick)
        };
        for order in due {
            self.give(order);
        }
        if wants_tick {
            self.environment.observations.report(Observation::Tick);
        }
        self.attend();
    }

    /// When the next tick is due, in nanoseconds of the container's clock.
    pub fn due_ns(&self) -> Option<u64> {
        let core = self.lock();
        let later = core.later.iter().map(|(time_ns, _)| *time_ns).min();
        let manager = core.manager.due().map(nanoseconds);
        let monitors = self
            .monitors
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .due_ns();
        let observations = self.environment.observations.due_ns();
        let injections = self.environment.injections.is_armed().then(|| {
            let period_ns = nanoseconds(LOOK_PERIOD);
            (self.injected_ns.load(Ordering::Relaxed) / period_ns + 1) * period_ns
        });
        [later, manager, monitors, observations, injections]
            .into_iter()
            .flatten()
            .min()
    }

    /// Sleeps until something may be due, at most `limit`.
    pub fn sleep(&self, limit: Duration) {
        self.wake.sleep(limit);
        self.wake.take();
    }

    /// Makes a thread that sleeps look again.
    pub fn rouse(&self) {
        self.wake.wake();
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

    /// Finds the backtrace of a component that was taken off, if one waits for that, and puts the
    /// verdict on record again with it; whether there was one.
    pub(super) fn find_backtrace(&self) -> bool {
        let Some((component, incarnation)) = self.environment.scenes.look_at_one() else {
            return false;
        };
        let mut core = self.lock();
        let verdicts = core.manager.verdicts();
        let of_it = verdicts
            .filter(|it| (it.component == component) && it.incarnation == incarnation)
            .last()
            .cloned();
        if let Some(verdict) = of_it {
            self.record(&mut core, verdict, Duration::ZERO);
        }
        true
    }

    /// Whether the emergency stop is latched.
    pub fn is_emergency(&self) -> bool {
        self.lock().manager.is_emergency()
    }

    /// Whether an observation is about an instance that is still there.
    fn is_of_now(&self, observation: &Observation) -> bool {
        let Observation::Symptom(symptom) = observation else {
            return true;
        };
        let core = self.lock();
        let detector = core.manager.detectors().get(symptom.detector.0);
        let status = detector.and_then(|detector| self.statuses.get(detector.component));
        status.is_some_and(|status| status.incarnation() == symptom.incarnation)
    }

    /// Faults that begin and end with time.
    fn inject(&self, now_ns: u64) {
        let environment = &self.environment;
        if !environment.injections.is_armed() {
            return;
        }
        self.injected_ns.store(now_ns, Ordering::Relaxed);
        let now = Duration::from_nanos(now_ns);
        let changed = environment
            .injections
            .advance(now, environment.world.as_deref());
        environment.record_injections(&changed);
    }

    fn process(&self) {
        while self.environment.observations.is_pending() {
            let mut core = match self.core.try_lock() {
                Ok(core) => core,
                Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
                // Whoever is at it looks again before it leaves.
                Err(TryLockError::WouldBlock) => return,
            };
            while let Some(observation) = self.environment.observations.take() {
                let now = self.environment.clock.now();
                let start = Instant::now();
                let effects = core.manager.observe(now, observation);
                let took = if self.environment.clock.is_simulated() {
                    Duration::ZERO
                } else {
                    start.elapsed()
                };
                for effect in effects {
                    self.carry_out(&mut core, effect, took);
                }
            }
            drop(core);
            self.rouse();
        }
    }

    fn carry_out(&self, core: &mut Core, effect: Effect, took: Duration) {
        match effect {
            Effect::Act(planned) => self.act(core, &planned),
            Effect::Abandon(action) => core.later.retain(|(_, order)| order.action != Some(action)),
            Effect::Record(verdict) => self.record(core, *verdict, took),
            Effect::Rearm => {
                for actuator in self.emergency.rearm(self.environment.clock.now_ns()) {
                    self.give(Order {
                        action: None,
                        component: actuator,
                        task: Task::Resume,
                    });
                }
            }
        }
    }

    fn act(&self, core: &mut Core, planned: &PlannedAction) {
        let now_ns = self.environment.clock.now_ns();
        let (component, task) = match &planned.action {
            Action::EmergencyStop => return self.stop_in_emergency(core, planned.id, now_ns),
            Action::Reset {
                component,
                checkpoint_before,
            } => (
                *component,
                Task::Reset {
                    checkpoint_before_ns: checkpoint_before.map(nanoseconds),
                },
            ),
            Action::Replace {
                component,
                secondary,
                checkpoint_before,
            } => (
                *component,
                Task::Replace {
                    variant: secondary + 1,
                    checkpoint_before_ns: checkpoint_before.map(nanoseconds),
                },
            ),
            Action::Stop { component } => (*component, Task::Stop),
            Action::Destroy { component } => (*component, Task::Destroy),
        };
        if let Some(limit) = hurry(&core.manager, planned) {
            self.orders[component].hurry(limit.into());
        }
        let order = Order {
            action: Some(planned.id),
            component,
            task,
        };
        let not_before_ns = nanoseconds(planned.not_before);
        if not_before_ns > now_ns {
            core.later.push((not_before_ns, order));
        } else {
            self.give(order);
        }
    }

    /// Safe commands at once, from this thread; then each actuator by its category.
    fn stop_in_emergency(&self, core: &mut Core, action: ActionId, now_ns: u64) {
        let stops = self.emergency.engage(action);
        self.raise(core, ManagerPort::EmergencyStop);
        if stops.is_empty() {
            self.ended(action, "no component is declared an actuator");
        }
        for stop in stops {
            self.give(Order {
                action: Some(action),
                component: stop.component,
                task: Task::EmergencyStop {
                    power_off: stop.power_off_after == Some(Duration::ZERO),
                },
            });
            if let Some(after) = stop.power_off_after.filter(|after| !after.is_zero()) {
                let order = Order {
                    action: None,
                    component: stop.component,
                    task: Task::Stop,
                };
                core.later.push((now_ns + nanoseconds(after), order));
            }
        }
    }

    fn ended(&self, action: ActionId, note: &str) {
        self.environment.observations.report(Observation::Ended {
            action,
            outcome: ActionOutcome::Done {
                incarnation: 0,
                note: note.to_owned(),
            },
        });
    }

    pub(super) fn give(&self, order: Order) {
        let action = order.action;
        let orders = self.orders.get(order.component);
        let given = orders.is_some_and(|orders| orders.give(order));
        if let (false, Some(action)) = (given, action) {
            self.environment.observations.report(Observation::Ended {
                action,
                outcome: ActionOutcome::Failed {
                    reason: "too many orders wait for its executor".to_owned(),
                },
            });
        }
    }

    fn record(&self, core: &mut Core, mut verdict: Verdict, took: Duration) {
        self.environment.scenes.complete(&mut verdict);
        let known = core.decision_us(verdict.id);
        if known.is_none() {
            // A verdict is recorded first when its fault is confirmed, and changes again only while
            // its decision is remembered, but for one that is very old.
            self.raise(core, ManagerPort::Fault);
        }
        verdict.decision_us += known.unwrap_or_else(|| core.time_decision(verdict.id, took));
        self.environment.events.record(
            self.environment.clock.now_ns(),
            Event::Verdict(Box::new(verdict)),
        );
    }

    fn lock(&self) -> MutexGuard<'_, Core> {
        self.core.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A component that has missed its heartbeats may be hanging long before its deadline: how long a
/// callback of its executor may take while the order waits.
fn hurry(manager: &FaultManager, planned: &PlannedAction) -> Option<Duration> {
    let mut verdicts = manager.verdicts();
    let verdict = verdicts.find(|verdict| verdict.id == planned.fault)?;
    match verdict.evidence {
        Evidence::Heartbeat { period_ms, .. } => Some(Duration::from_secs_f64(period_ms / 1e3)),
        _ => None,
    }
}

/// A duration in nanoseconds; 584 years are enough.
pub(crate) fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
