//! A component instance in the container: life cycle, ports, and what became of it.

mod cell;
mod checkpoint;
mod inheritance;
mod injected;
mod instance;
mod judgement;
mod limits;
mod messages;
mod port_end;
mod restored;
mod services;
mod succession;
mod tap;

use std::sync::Arc;
use std::time::Duration;

use fault_manager::Observation;
use system_model::fault::Fault;
use system_model::life_cycle::{LifeCycleState, Operation, Transition, transition};

use crate::event_log::Event;
use crate::guard::loss::{Loss, LostThread};
use crate::guard::{Callback, Ending};
use crate::status::ComponentStatus;
use crate::wake::Wake;
use limits::Limits;

pub(crate) use cell::mark_lost;
pub use cell::{ComponentCell, Entered};
pub use checkpoint::Checkpoints;
pub use inheritance::Inheritance;
pub use instance::{Instance, Scene, Stray};
pub use limits::CallLimits;
pub use port_end::{
    BoundMethod, Calls, DataInput, DataOutput, EventOutput, Inbox, PortEnd, Provider,
};
pub use restored::Restored;
pub use services::{Detectors, Environment, Services};
pub use tap::{InputTap, OutputTap, SafeDatum, VotedInput, VotingSource, Watch};

/// One component instance.
pub struct Component {
    name: Arc<str>,
    instance: Instance,
    services: Services,
    status: Arc<ComponentStatus>,
    period: Duration,
    numbering: succession::Numbering,
    checkpoints: Option<Box<Checkpoints>>,
    /// Recovered, and no cycle completed since: the fault manager waits for one.
    unproven: bool,
    /// Whether the library's constructor has run.
    constructed: bool,
    /// Which of the component's libraries it is of: its own (0) or that of a secondary (from 1).
    variant: usize,
    limits: Limits,
    /// Whether a rule asks how much memory it uses.
    counts_allocations: bool,
    /// What the limits are by the container's clock, which need not be the machine's.
    nominal: CallLimits,
    /// Where it was when it was taken off.
    scene: Option<Scene>,
    /// What wakes its executor.
    executor: Option<Arc<Wake>>,
}

/// Why an operation did not bring the component where it should be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OperationError {
    /// Not allowed in this state (405).
    Refused,
    /// The callback failed; the fault is on record.
    Failed(Box<Fault>),
}

impl Component {
    /// Puts an instance together. Nothing of it runs yet.
    pub fn new(
        instance: impl Into<Instance>,
        services: Services,
        status: Arc<ComponentStatus>,
        period: Duration,
    ) -> Self {
        let instance = instance.into();
        status.set_in_host(matches!(instance, Instance::Hosted(_)));
        Self {
            name: Arc::clone(services.name()),
            instance,
            services,
            status,
            period,
            numbering: succession::Numbering::default(),
            checkpoints: None,
            unproven: false,
            constructed: false,
            variant: 0,
            limits: CallLimits::default().into(),
            nominal: CallLimits::default(),
            counts_allocations: false,
            scene: None,
            executor: None,
        }
    }

    /// Sets how long its callbacks may take by the container's clock; before that the default
    /// holds.
    pub fn set_limits(&mut self, limits: CallLimits) {
        let clock = &self.services.environment().clock;
        self.limits = limits.by_clock(clock).into();
        self.nominal = limits;
    }

    /// From now on its status tells how much memory its callbacks have allocated and not freed.
    pub fn count_allocations(&mut self) {
        self.counts_allocations = true;
        self.instance.count_allocations();
    }

    /// Whose thread calls it from now on. In simulated time nobody is woken by what happens
    /// outside of it.
    pub fn run_by(&mut self, executor: Arc<Wake>) {
        if !self.services.environment().clock.is_simulated() {
            self.instance.run_by(&executor);
        }
        self.executor = Some(executor);
    }

    /// Instance name.
    pub fn name(&self) -> &Arc<str> {
        &self.name
    }

    /// Its ports and all that it may ask for.
    pub fn services_mut(&mut self) -> &mut Services {
        &mut self.services
    }

    /// What the container knows of it.
    pub fn status(&self) -> &Arc<ComponentStatus> {
        &self.status
    }

    /// Life-cycle state.
    pub fn state(&self) -> LifeCycleState {
        self.status.state()
    }

    /// Whether the instance can still be called.
    pub fn is_alive(&self) -> bool {
        self.instance.is_alive()
    }

    /// Makes the instance and tells it its period.
    ///
    /// # Errors
    /// If its constructor fails.
    pub fn construct(&mut self, loss: &Loss) -> Result<(), OperationError> {
        let period_ns = u64::try_from(self.period.as_nanos()).unwrap_or(u64::MAX);
        self.run(Callback::Create, "create", loss)
            .and_then(|()| self.run(Callback::PeriodChanged(period_ns), "onPeriodChanged", loss))
            .map_err(OperationError::Failed)
    }

    /// Performs a life-cycle operation.
    ///
    /// # Errors
    /// If it is not allowed now, or a callback fails.
    pub fn operate(&mut self, operation: Operation, loss: &Loss) -> Result<(), OperationError> {
        let target = match transition(self.state(), operation) {
            Transition::AlreadyThere => return Ok(()),
            Transition::Refused => return Err(OperationError::Refused),
            Transition::Run(target) => target,
        };
        if !self.instance.is_alive() {
            // Nothing of an abandoned instance is called again: it can only be given up.
            if operation != Operation::Destroy {
                return Err(OperationError::Refused);
            }
            self.enter_state(target);
            return Ok(());
        }
        for (callback, name) in callbacks(operation) {
            self.run(*callback, name, loss)
                .map_err(OperationError::Failed)?;
        }
        match operation {
            Operation::Stop => self.services.clear_inputs(),
            Operation::Destroy => {
                self.run(Callback::DestroyInstance, "destroy", loss)
                    .map_err(OperationError::Failed)?;
            }
            _ => {}
        }
        self.enter_state(target);
        Ok(())
    }

    /// Runs one callback of the life cycle by itself; the state is the caller's matter.
    ///
    /// # Errors
    /// The fault, if it fails.
    pub fn call_back(
        &mut self,
        callback: Callback,
        name: &'static str,
        loss: &Loss,
    ) -> Result<(), OperationError> {
        self.run(callback, name, loss)
            .map_err(OperationError::Failed)
    }

    /// Whether the executor has work for it.
    pub fn is_active(&self) -> bool {
        self.state() == LifeCycleState::Active
    }

    /// One `onExecute` at `now_ns` of the container's clock.
    #[inline]
    pub fn execute(&mut self, now_ns: u64, loss: &Loss) {
        self.services.begin_cycle(now_ns);
        if self
            .run_or_fail(Callback::Execute, "onExecute", loss)
            .is_ok()
        {
            self.services.work_done();
            self.status.count_cycle();
            if self.unproven {
                self.prove();
            }
        }
    }

    /// One `onUpdated`, and a checkpoint if one is due.
    #[inline]
    pub fn updated(&mut self, loss: &Loss) {
        // The fault, if any, is on record; the executor goes on with the next component.
        let recorded = self.run_or_fail(Callback::Updated, "onUpdated", loss);
        if let Some(checkpoints) = &mut self.checkpoints
            && recorded.is_ok()
        {
            checkpoints.take_if_due(&self.services, self.variant);
        }
    }

    /// Whether a thread that the component made itself has met a fault since the last look.
    #[inline]
    pub fn look_for_stray_fault(&mut self) {
        if let Some(stray) = self.instance.take_stray_fault() {
            let fault = match stray {
                Stray::Thread(trap) => judgement::stray_fault(&trap),
                Stray::HostEnded => self.host_ended("no callback"),
            };
            self.record(&fault);
            self.enter_state(LifeCycleState::Error);
            self.report(&fault);
        }
    }

    /// Whether it could be called if it were now: an instance that stood by may have died.
    pub fn is_fit(&self) -> bool {
        self.instance.is_fit()
    }

    /// The thread was lost inside this component. Whether that is a symptom, or the failure of
    /// what the fault manager itself had asked for, is for the caller to say.
    pub fn lost(&mut self, thread: &LostThread) -> Fault {
        self.instance.quarantine();
        self.scene = self.instance.scene(Some(&thread.trap));
        let fault = judgement::trap_fault(&thread.trap, self.services.callback(), true);
        self.record(&fault);
        self.enter_state(LifeCycleState::Error);
        fault
    }

    /// Counts an overrun of its executor.
    pub fn overran(&self) {
        self.status.count_overrun();
    }

    /// The fault manager waits for its next completed cycle.
    pub fn expect_proof(&mut self) {
        self.unproven = true;
    }

    /// Whether no cycle was completed since the last recovery.
    pub fn is_unproven(&self) -> bool {
        self.unproven
    }

    /// Tells the fault manager that the component works again.
    #[cold]
    pub fn prove(&mut self) {
        self.unproven = false;
        let now_ns = self.services.environment().clock.now_ns();
        self.status.set_works_since_ns(now_ns);
        if let Some(component) = self.services.detectors().map(|all| all.component) {
            self.services
                .environment()
                .observations
                .report(Observation::Works {
                    component,
                    incarnation: self.services.incarnation(),
                });
        }
    }

    #[inline]
    fn run_or_fail(
        &mut self,
        callback: Callback,
        name: &'static str,
        loss: &Loss,
    ) -> Result<(), Box<Fault>> {
        let result = self.run(callback, name, loss);
        if let Err(fault) = &result {
            self.fail(fault, loss);
        }
        result
    }

    /// ACTIVE -> ERROR, with `onError` where the instance can still be called.
    #[cold]
    fn fail(&mut self, fault: &Fault, loss: &Loss) {
        let told = self.instance.is_alive() && self.operate(Operation::StopOnError, loss).is_ok();
        if !told {
            self.enter_state(LifeCycleState::Error);
        }
        self.report(fault);
    }

    /// Runs a callback and records what goes wrong. (The fault is boxed so that success travels
    /// in a register: this runs several times a cycle.)
    #[inline]
    fn run(
        &mut self,
        callback: Callback,
        name: &'static str,
        loss: &Loss,
    ) -> Result<(), Box<Fault>> {
        self.services.begin(name);
        let mut limit = self.limits.of(callback);
        if self.services.environment().injections.is_armed() {
            limit = self.inject(callback, name).unwrap_or(limit);
        }
        let ending = self
            .instance
            .call(callback, limit, loss, &mut self.services);
        if self.counts_allocations {
            self.tell_allocations();
        }
        match ending {
            Ending::Returned(status) if status.is_success() && !self.services.has_bad_pointer() => {
                Ok(())
            }
            other => Err(self.judge(other, callback, name)),
        }
    }

    fn tell_allocations(&self) {
        let bytes = self.instance.allocated_bytes();
        self.status.set_allocated_bytes(bytes);
    }

    fn enter_state(&mut self, state: LifeCycleState) {
        let from = self.state();
        if from == state {
            return;
        }
        self.status.set_state(state);
        if self.status.is_standby() {
            return;
        }
        self.services.record(Event::State {
            component: self.name.to_string(),
            from: from.name(),
            to: state.name(),
            incarnation: self.services.incarnation(),
        });
    }
}

/// The callbacks of an operation, in the order of the OPRoS life cycle.
fn callbacks(operation: Operation) -> &'static [(Callback, &'static str)] {
    match operation {
        Operation::Initialize => &[(Callback::Initialize, "onInitialize")],
        Operation::Start => &[(Callback::Start, "onStart")],
        Operation::Stop => &[(Callback::Stop, "onStop")],
        Operation::StopOnError => &[(Callback::Error, "onError")],
        Operation::Recover => &[(Callback::Recover, "onRecover")],
        Operation::Reset => &[
            (Callback::Reset, "onReset"),
            (Callback::Initialize, "onInitialize"),
            (Callback::Start, "onStart"),
        ],
        Operation::Destroy => &[(Callback::Destroy, "onDestroy")],
    }
}
