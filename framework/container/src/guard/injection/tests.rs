//! Every misbehaviour, on a component that is healthy and does not know.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use component_abi::{Callbacks, HostContext, HostTable, Instance, Status};

use super::Misbehaviour;
use crate::guard::loss::Loss;
use crate::guard::{
    CallLimit, Callback, CodeRange, Ending, Exit, Guarded, HostServices, Request, Trap, interrupt,
};

thread_local! {
    /// How often the component's own callback ran on this thread.
    static RUNS: Cell<u32> = const { Cell::new(0) };
}

const HEALTHY: Callbacks = Callbacks {
    create: Some(create),
    on_execute: Some(on_execute),
    ..Callbacks::NONE
};

unsafe extern "C" fn create(_: *const HostTable, _: *mut HostContext) -> *mut Instance {
    std::ptr::dangling_mut()
}

unsafe extern "C" fn on_execute(_: *mut Instance) -> Status {
    RUNS.set(RUNS.get() + 1);
    Status::SUCCESS
}

/// Keeps the explanation of a failure.
#[derive(Default)]
struct Listener {
    explanation: Option<String>,
}

impl HostServices for Listener {
    fn answer(&mut self, request: &Request) -> u64 {
        if let Request::Failed(message, ..) = request {
            self.explanation = message.read();
        }
        0
    }
}

/// A component that was made, and where its thread leaves word.
struct Subject {
    guarded: Guarded,
    loss: Arc<Loss>,
    listener: Listener,
}

impl Subject {
    fn new() -> Self {
        Guarded::prepare_thread().expect("a stack for the handler");
        let code = CodeRange { start: 0, end: 0 };
        let mut subject = Self {
            guarded: Guarded::new(HEALTHY, code, 0).expect("a stack"),
            loss: Arc::default(),
            listener: Listener::default(),
        };
        let made = subject.call(Callback::Create);
        assert_eq!(made, Ending::Returned(Status::SUCCESS));
        subject
    }

    fn call(&mut self, callback: Callback) -> Ending {
        let limit = CallLimit::from(Duration::from_millis(1));
        self.guarded
            .call(callback, limit, &self.loss, &mut self.listener)
    }

    fn execute_with(&mut self, misbehaviour: Misbehaviour) -> Ending {
        self.guarded.inject(Some(misbehaviour));
        RUNS.set(0);
        self.call(Callback::Execute)
    }
}

fn trap(ending: Ending) -> Trap {
    match ending {
        Ending::Trapped(trap) => trap,
        other => panic!("no trap: {other:?}"),
    }
}

#[test]
fn traps() {
    for (misbehaviour, signal, overflow) in [
        (Misbehaviour::Segfault, libc::SIGSEGV, false),
        (Misbehaviour::BusError, libc::SIGBUS, false),
        (Misbehaviour::DivideByZero, libc::SIGFPE, false),
        (Misbehaviour::IllegalInstruction, libc::SIGILL, false),
        (Misbehaviour::StackOverflow, libc::SIGSEGV, true),
    ] {
        let mut subject = Subject::new();
        let trap = trap(subject.execute_with(misbehaviour));
        assert_eq!(trap.signal, signal, "{misbehaviour:?}");
        assert_eq!(trap.stack_overflow, overflow, "{misbehaviour:?}");
        assert_eq!(trap.hang, None, "{misbehaviour:?}");
        assert_eq!(RUNS.get(), 0, "{misbehaviour:?}: instead of the callback");
        assert!(!subject.guarded.is_alive(), "{misbehaviour:?}");
        assert_eq!(subject.call(Callback::Execute), Ending::Gone);
    }
}

#[test]
fn leaving() {
    for (misbehaviour, exit) in [
        (Misbehaviour::Abort, Exit::Abort),
        (Misbehaviour::Exit, Exit::Exit(1)),
    ] {
        let mut subject = Subject::new();
        assert_eq!(subject.execute_with(misbehaviour), Ending::Left(exit));
        assert!(!subject.guarded.is_alive(), "{misbehaviour:?}");
    }
}

#[test]
fn answers_are_explained() {
    for (misbehaviour, status, explanation) in [
        (Misbehaviour::Panic, Status::PANICKED, "injected panic"),
        (
            Misbehaviour::ErrorReturn(503),
            Status(503),
            "injected error return",
        ),
    ] {
        let mut subject = Subject::new();
        let ending = subject.execute_with(misbehaviour);
        assert_eq!(ending, Ending::Returned(status));
        let said = subject.listener.explanation.as_deref();
        assert_eq!(said, Some(explanation));
        assert_eq!(RUNS.get(), 0);
    }
}

/// Slow and leaking callbacks do their work all the same, and once is once.
#[test]
fn before_the_callback() {
    let time = Duration::from_millis(20);
    let mut subject = Subject::new();
    let start = Instant::now();
    let fine = Ending::Returned(Status::SUCCESS);
    assert_eq!(subject.execute_with(Misbehaviour::Slow(time)), fine);
    assert!(start.elapsed() >= time);
    assert_eq!(RUNS.get(), 1);
    assert_eq!(subject.execute_with(Misbehaviour::Leak(1 << 20)), fine);
    assert_eq!(RUNS.get(), 1);
    assert_eq!(subject.call(Callback::Execute), fine);
    assert_eq!(RUNS.get(), 2);
}

#[test]
fn an_injection_can_be_taken_back() {
    let mut subject = Subject::new();
    subject.guarded.inject(Some(Misbehaviour::Segfault));
    subject.guarded.inject(None);
    let ending = subject.call(Callback::Updated);
    assert_eq!(ending, Ending::Returned(Status::SUCCESS));
}

/// Taken off by what the watchdog does, also while it is merely slow.
#[test]
fn hangs() {
    for misbehaviour in [
        Misbehaviour::Hang,
        Misbehaviour::Slow(Duration::from_secs(3600)),
    ] {
        let mut subject = Subject::new();
        subject.loss.watch().attach();
        let over = Arc::new(AtomicBool::new(false));
        let (seen, loss) = (Arc::clone(&over), Arc::clone(&subject.loss));
        let watchdog = std::thread::spawn(move || {
            while !seen.load(Ordering::Acquire) {
                let inside = loss.watch().inside();
                if inside.depth > 0 {
                    loss.watch().condemn(inside.generation);
                    interrupt(loss.watch().thread().expect("it is attached"));
                }
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        let trap = trap(subject.execute_with(misbehaviour));
        over.store(true, Ordering::Release);
        watchdog.join().expect("it ends");
        assert_eq!(trap.hang, Some(Duration::from_millis(1)));
        assert!(!subject.guarded.is_alive());
    }
}
