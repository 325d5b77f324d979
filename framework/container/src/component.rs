//! A component instance in the container: life cycle, ports, and what became of it.

mod cell;
mod limits;
mod port_end;
mod services;

use std::sync::Arc;
use std::time::Duration;

use component_abi::Status;
use system_model::fault::{Fault, FaultKind, SignalEvidence};
use system_model::life_cycle::{LifeCycleState, Operation, Transition, transition};

use crate::event_log::Event;
use crate::guard::loss::{Loss, LostThread};
use crate::guard::{Callback, Ending, Exit, Guarded, Misbehaviour, Scene, ServiceCall, Trap};
use crate::status::ComponentStatus;
use limits::Limits;

pub(crate) use cell::mark_lost;
pub use cell::{ComponentCell, Entered};
pub use limits::CallLimits;
pub use port_end::{BoundMethod, Calls, DataOutput, EventOutput, Inbox, PortEnd, Provider};
pub use services::{Environment, Services};

/// One component instance.
pub struct Component {
    name: Arc<str>,
    incarnation: u32,
    guarded: Guarded,
    services: Services,
    status: Arc<ComponentStatus>,
    period: Duration,
    limits: Limits,
    /// Where it was when it was taken off.
    scene: Option<Scene>,
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
        guarded: Guarded,
        services: Services,
        status: Arc<ComponentStatus>,
        period: Duration,
    ) -> Self {
        Self {
            name: Arc::clone(services.name()),
            incarnation: status.incarnation(),
            guarded,
            services,
            status,
            period,
            limits: CallLimits::default().into(),
            scene: None,
        }
    }

    /// Where in its code the component was when a trap or the watchdog ended it, once: the
    /// evidence beside the fault. Its backtrace is for a thread that has time.
    pub fn take_scene(&mut self) -> Option<Scene> {
        self.scene.take()
    }

    /// Lets it misbehave when its next callback is due; it does not know.
    pub fn inject(&mut self, misbehaviour: Option<Misbehaviour>) {
        self.guarded.inject(misbehaviour);
    }

    /// Sets how long its callbacks may take; before that the default holds.
    pub fn set_limits(&mut self, limits: CallLimits) {
        self.limits = limits.into();
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
        if !self.guarded.is_alive() {
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

    /// Whether the executor has work for it.
    pub fn is_active(&self) -> bool {
        self.state() == LifeCycleState::Active
    }

    /// One `onExecute` at `now_ns` of the container's clock.
    #[inline]
    pub fn execute(&mut self, now_ns: u64, loss: &Loss) {
        self.services.set_cycle_time(now_ns);
        if self
            .run_or_fail(Callback::Execute, "onExecute", loss)
            .is_ok()
        {
            self.status.count_cycle();
        }
    }

    /// One `onUpdated`.
    #[inline]
    pub fn updated(&mut self, loss: &Loss) {
        // The fault, if any, is on record; the executor goes on with the next component.
        let _recorded = self.run_or_fail(Callback::Updated, "onUpdated", loss);
    }

    /// Delivers events and queued calls that have arrived. To a component that is not active
    /// nothing is delivered: what arrives meanwhile is thrown away.
    pub fn deliver(&mut self, now_ns: u64, loss: &Loss) {
        self.services.set_cycle_time(now_ns);
        self.look_for_stray_fault();
        for inbox in 0..self.services.inboxes() {
            while let Some((port, method, message)) = self.services.take_message(inbox) {
                if self.is_active() {
                    let size = message.bytes().len();
                    let (callback, name) = match method {
                        None => (
                            Callback::Event(port, message.bytes().as_ptr(), size),
                            "onEvent",
                        ),
                        Some(method) => (
                            Callback::Call(ServiceCall {
                                port,
                                method,
                                request: message.bytes().as_ptr(),
                                request_size: size,
                                reply: std::ptr::null_mut(),
                                reply_size: 0,
                            }),
                            "onCall",
                        ),
                    };
                    let _recorded = self.run_or_fail(callback, name, loss);
                }
                self.services.give_back(inbox, message);
            }
        }
    }

    /// Serves a blocking call of another component, on that component's thread.
    pub fn serve(&mut self, call: ServiceCall, now_ns: u64, loss: &Loss) -> Status {
        if !self.is_active() {
            return Status::PRECONDITION_NOT_MET;
        }
        self.services.set_cycle_time(now_ns);
        match self.run(Callback::Call(call), "onCall", loss) {
            Ok(()) => Status::SUCCESS,
            // The callee said no. That is on record, but the callee goes on.
            Err(fault) if fault.kind == FaultKind::ErrorReturn => self.services.last_status(),
            Err(_fault) => {
                self.enter_state(LifeCycleState::Error);
                Status::INTERNAL_FAULT
            }
        }
    }

    /// Whether a thread that the component made itself has met a fault since the last look.
    #[inline]
    pub fn look_for_stray_fault(&mut self) {
        if let Some(trap) = self.guarded.take_stray_fault() {
            let mut fault = trap_fault(&trap, "a thread of its own", false);
            fault.message.push_str(": that thread was stopped");
            self.record(fault);
            self.enter_state(LifeCycleState::Error);
        }
    }

    /// The thread was lost inside this component.
    pub fn lost(&mut self, thread: &LostThread) {
        self.guarded.quarantine();
        self.scene = self.guarded.scene(&thread.trap);
        self.record(trap_fault(&thread.trap, self.services.callback(), true));
        self.enter_state(LifeCycleState::Error);
    }

    /// Counts an overrun of its executor.
    pub fn overran(&self) {
        self.status.count_overrun();
    }

    fn run_or_fail(
        &mut self,
        callback: Callback,
        name: &'static str,
        loss: &Loss,
    ) -> Result<(), Box<Fault>> {
        let result = self.run(callback, name, loss);
        if result.is_err() {
            self.fail(loss);
        }
        result
    }

    /// ACTIVE -> ERROR, with `onError` where the instance can still be called.
    fn fail(&mut self, loss: &Loss) {
        if self.guarded.is_alive() && self.operate(Operation::StopOnError, loss).is_ok() {
            return;
        }
        self.enter_state(LifeCycleState::Error);
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
        let limit = self.limits.of(callback);
        let ending = self.guarded.call(callback, limit, loss, &mut self.services);
        match ending {
            Ending::Returned(status) if status.is_success() && !self.services.has_bad_pointer() => {
                Ok(())
            }
            other => Err(self.judge(other, name)),
        }
    }

    #[cold]
    fn judge(&mut self, ending: Ending, callback: &'static str) -> Box<Fault> {
        let fault = match ending {
            Ending::Returned(status) => self.services.returned_fault(status, callback),
            Ending::Trapped(trap) => {
                self.scene = self.guarded.scene(&trap);
                trap_fault(&trap, callback, false)
            }
            Ending::Left(Exit::Abort) => {
                Fault::new(FaultKind::Abort, callback, "abort()".to_owned())
            }
            Ending::Left(Exit::Exit(code)) => {
                Fault::new(FaultKind::Exit, callback, format!("exit({code})"))
            }
            Ending::Gone => Fault::new(
                FaultKind::ErrorReturn,
                callback,
                "called after it had ended".to_owned(),
            ),
        };
        if fault.kind == FaultKind::Panic {
            self.guarded.quarantine();
        }
        self.record(fault.clone());
        // A component that hands out bad pointers must not be started; one that is active goes to
        // ERROR by way of `onError`.
        let unfit = fault.kind == FaultKind::BadPointer && !self.is_active();
        if unfit || !self.guarded.is_alive() {
            self.enter_state(LifeCycleState::Error);
        }
        Box::new(fault)
    }

    fn record(&self, fault: Fault) {
        self.status.count_fault(format!(
            "{} in {}: {}",
            fault.kind, fault.callback, fault.message
        ));
        let event = Event::fault(&self.name, self.incarnation, &fault);
        self.services.record(event);
    }

    fn enter_state(&mut self, state: LifeCycleState) {
        let from = self.state();
        if from == state {
            return;
        }
        self.status.set_state(state);
        self.services.record(Event::State {
            component: self.name.to_string(),
            from: from.name(),
            to: state.name(),
            incarnation: self.incarnation,
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

/// The fault that a trap stands for. Addresses that differ from run to run are left out unless
/// they say something: a null dereference is near zero in every run.
fn trap_fault(trap: &Trap, callback: &'static str, thread_lost: bool) -> Fault {
    /// The first page is never mapped: an address in it is a field of a null pointer.
    const NULL_PAGE: usize = 4096;
    let kind = match trap.signal {
        _ if trap.hang.is_some() => FaultKind::Hang,
        _ if trap.stack_overflow => FaultKind::StackOverflow,
        libc::SIGBUS => FaultKind::BusError,
        libc::SIGFPE => FaultKind::DivideByZero,
        libc::SIGILL | libc::SIGTRAP => FaultKind::IllegalInstruction,
        libc::SIGABRT => FaultKind::Abort,
        _ => FaultKind::Segfault,
    };
    let signal = signal_name(trap.signal);
    let mut message = match kind {
        FaultKind::Hang => {
            let limit = trap.hang.unwrap_or_default();
            format!("it did not return within {limit:?}")
        }
        FaultKind::StackOverflow => "the stack's guard area was hit".to_owned(),
        _ => signal.to_owned(),
    };
    if matches!(kind, FaultKind::Segfault) && trap.address < NULL_PAGE {
        message = format!("{signal} at address {:#x} (null pointer)", trap.address);
    }
    if thread_lost {
        message.push_str(", outside the component's own code: its thread was set aside");
    }
    Fault {
        thread_lost,
        signal: Some(SignalEvidence {
            name: signal_name(trap.signal),
            code: trap.code,
            address: trap.address,
            backtrace: Vec::new(),
        }),
        ..Fault::new(kind, callback, message)
    }
}

fn signal_name(signal: i32) -> &'static str {
    match signal {
        libc::SIGBUS => "SIGBUS",
        libc::SIGFPE => "SIGFPE",
        libc::SIGILL => "SIGILL",
        libc::SIGTRAP => "SIGTRAP",
        libc::SIGABRT => "SIGABRT",
        libc::SIGSEGV => "SIGSEGV",
        _ => "watchdog",
    }
}
