//! From the way a callback ended to a fault: on record, and reported to the fault manager.

use std::time::Duration;

use fault_manager::{Evidence, Observation, Symptom};
use system_model::fault::{Fault, FaultKind, SignalEvidence};
use system_model::life_cycle::LifeCycleState;

use super::Component;
use crate::clock::nanoseconds;
use crate::event_log::Event;
use crate::guard::{Callback, Ending, Exit, Trap};

/// The first page is never mapped: an address in it is a field of a null pointer.
const NULL_PAGE: usize = 4096;

/// A host that is dead is reaped within milliseconds, unless it had very much memory.
const HOST_END: Duration = Duration::from_secs(1);

impl Component {
    #[cold]
    pub(super) fn judge(
        &mut self,
        ending: Ending,
        called: Callback,
        callback: &'static str,
    ) -> Box<Fault> {
        self.time_misbehaviour();
        let mut fault = match ending {
            Ending::Returned(status) => self.services.returned_fault(status, callback),
            Ending::Trapped(trap) => {
                self.scene = self.instance.scene(Some(&trap));
                trap_fault(&trap, callback, false)
            }
            Ending::Left(Exit::Abort) => {
                Fault::new(FaultKind::Abort, callback, "abort()".to_owned())
            }
            Ending::Left(Exit::Exit(code)) => {
                Fault::new(FaultKind::Exit, callback, format!("exit({code})"))
            }
            Ending::HostEnded => self.host_ended(callback),
            Ending::Gone => Fault::new(
                FaultKind::ErrorReturn,
                callback,
                "called after it had ended".to_owned(),
            ),
        };
        match fault.kind {
            FaultKind::Panic => self.instance.quarantine(),
            FaultKind::Hang => self.judge_hang(&mut fault, called),
            _ => {}
        }
        self.record(&fault);
        // A component that hands out bad pointers must not be started; one that is active goes to
        // ERROR by way of `onError`.
        let unfit = fault.kind == FaultKind::BadPointer && !self.is_active();
        if unfit || !self.instance.is_alive() {
            self.enter_state(LifeCycleState::Error);
        }
        Box::new(fault)
    }

    /// The process that the component ran in has ended.
    #[cold]
    pub(super) fn host_ended(&mut self, callback: &'static str) -> Fault {
        let environment = self.services.environment();
        let mut message = "its host process ended".to_owned();
        if environment.clock.is_simulated()
            && let Some(ending) = self.instance.end_of_host(HOST_END)
        {
            message = format!("{message}: {ending}");
        }
        self.scene = self.instance.scene(None);
        Fault::new(FaultKind::HostEnded, callback, message)
    }

    /// Notes when an injected misbehaviour acted, for whoever measures a recovery.
    fn time_misbehaviour(&self) {
        let clock = &self.services.environment().clock;
        let acted = self.instance.misbehaved();
        if let Some(time_ns) = acted.and_then(|acted| clock.at_ns(acted)) {
            self.status.set_misbehaved_ns(time_ns);
        }
    }

    /// In simulated time a hang has lasted for as long as the rules say.
    fn judge_hang(&mut self, fault: &mut Fault, called: Callback) {
        let environment = self.services.environment();
        if environment.clock.is_simulated() {
            let limit = self.nominal.of(called);
            environment.busy.add(limit);
            let until_ns = environment.clock.now_ns() + nanoseconds(limit);
            self.status.set_hanging_until(until_ns);
            fault.message = hang_message(limit);
            fault.lasted = limit;
        }
    }

    pub(super) fn record(&self, fault: &Fault) {
        self.status.count_fault(format!(
            "{} in {}: {}",
            fault.kind, fault.callback, fault.message
        ));
        let event = Event::fault(&self.name, self.services.incarnation(), fault);
        self.services.record(event);
    }

    /// Tells the fault manager, once the component is in the state that the fault brought it to.
    pub fn report(&mut self, fault: &Fault) {
        self.services.leave_work(self.is_active());
        let Some(detectors) = self.services.detectors() else {
            return;
        };
        let environment = self.services.environment();
        let simulated = environment.clock.is_simulated();
        let backtrace = match self.scene.take() {
            // There time waits for it.
            Some(scene) if simulated => scene.backtrace(),
            Some(scene) => {
                let incarnation = self.services.incarnation();
                environment.scenes.leave(&self.name, incarnation, scene);
                Vec::new()
            }
            None => Vec::new(),
        };
        let now = environment.clock.now();
        let symptom = Symptom {
            detector: match fault.kind {
                FaultKind::Hang => detectors.hang,
                _ => detectors.exception,
            },
            incarnation: self.services.incarnation(),
            kind: fault.kind,
            return_code: fault.return_code,
            at: if simulated {
                now
            } else {
                now.saturating_sub(fault.lasted)
            },
            runs: self.is_active(),
            evidence: exception(fault, backtrace, simulated, self.instance.is_guarded()),
        };
        let observation = Observation::Symptom(Box::new(symptom));
        let observations = &environment.observations;
        if simulated && !fault.lasted.is_zero() {
            let seen_ns = environment.clock.now_ns() + nanoseconds(fault.lasted);
            observations.report_at(seen_ns, observation);
        } else {
            observations.report(observation);
        }
    }

    /// Tells the fault manager of a component that failed while the application was brought up.
    pub fn report_error_at_start(&mut self, fault: &Fault) {
        if self.state() == LifeCycleState::Error {
            self.report(fault);
        }
    }
}

/// A fault as evidence. What differs from run to run is left out of simulated runs.
fn exception(fault: &Fault, backtrace: Vec<String>, simulated: bool, guarded: bool) -> Evidence {
    let signal = fault.signal.as_ref();
    Evidence::Exception {
        callback: fault.callback.to_owned(),
        message: fault.message.clone(),
        place: fault
            .place
            .as_ref()
            .map(|(file, line, column)| format!("{file}:{line}:{column}")),
        signal: signal.map(|signal| signal.name.to_owned()),
        address: signal
            .filter(|signal| !simulated || signal.address < NULL_PAGE)
            .map(|signal| format!("{:#x}", signal.address)),
        backtrace,
        thread_lost: fault.thread_lost,
        damage: if guarded { damage(fault) } else { None },
    }
}

/// What a fault may have done to others in the same process.
fn damage(fault: &Fault) -> Option<&'static str> {
    match (fault.kind, fault.thread_lost) {
        // The C library aborts when it finds its heap damaged; a wild pointer that was caught may
        // not have been the first.
        (FaultKind::Segfault | FaultKind::BusError, _) | (FaultKind::Abort, true) => Some(
            "memory of other components may be damaged; \
             <isolation>process</isolation> would have contained this",
        ),
        (_, true) => Some(
            "a lock of the C library may be held for ever; \
             <isolation>process</isolation> would have contained this",
        ),
        _ => None,
    }
}

/// The fault of a thread that the component made itself.
pub(super) fn stray_fault(trap: &Trap) -> Fault {
    let mut fault = trap_fault(trap, "a thread of its own", false);
    fault.message.push_str(": that thread was stopped");
    fault
}

/// The fault that a trap stands for. Addresses that differ from run to run are left out unless
/// they say something: a null dereference is near zero in every run.
pub(super) fn trap_fault(trap: &Trap, callback: &'static str, thread_lost: bool) -> Fault {
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
        FaultKind::Hang => hang_message(trap.hang.unwrap_or_default()),
        FaultKind::StackOverflow => "the stack's guard area was hit".to_owned(),
        FaultKind::Segfault if trap.address < NULL_PAGE => {
            format!("{signal} at address {:#x} (null pointer)", trap.address)
        }
        _ => signal.to_owned(),
    };
    if thread_lost {
        message.push_str(", outside the component's own code: its thread was set aside");
    }
    Fault {
        thread_lost,
        lasted: trap.hang.unwrap_or_default(),
        signal: Some(SignalEvidence {
            name: signal,
            code: trap.code,
            address: trap.address,
        }),
        ..Fault::new(kind, callback, message)
    }
}

fn hang_message(limit: Duration) -> String {
    format!("it did not return within {limit:?}")
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
