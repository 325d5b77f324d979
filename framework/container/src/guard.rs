//! The guard: every component instance runs on a stack of its own, as a coroutine.
//!
//! The container resumes it with a call; a host service that the component asks for suspends back,
//! so that container code runs on the container's stack (all but three, see `host`). A trap with
//! the stack pointer inside a component's stack is that component's fault: the handler makes the
//! coroutine return a record of it, and no frame of ours is skipped. The stack is then quarantined:
//! never reused, never freed, like a coroutine that is never resumed.
//!
//! Survives: traps, aborts, `exit`, stack overflow into the guard area, panics, and hangs where a
//! watchdog watches. Does not survive: memory that the component corrupted before it trapped; a
//! lock of the C library that it held.
#![allow(unsafe_code)] // the whole point: foreign code, stacks, signals

mod allocation;
mod bare_trap;
mod callback;
mod code;
mod copy;
mod foreign;
mod hang;
mod heap;
mod host;
mod injection;
mod interpose;
pub mod loss;
mod registers;
mod scene;
mod serve;
mod signals;
mod stack;
mod stray;
mod table;
mod ticks;
mod trap;
pub mod watch;

use std::hint::black_box;
use std::io;
use std::mem;
use std::ptr;
use std::time::Instant;

use component_abi::Callbacks;
use corosensei::{Coroutine, CoroutineResult};

pub use bare_trap::BareTrap;
pub use callback::{Callback, Ending, ServiceCall};
pub use code::{CodeRange, LoadedObject};
pub use foreign::{ForeignBytes, ForeignBytesMut, ForeignText};
pub use hang::interrupt;
pub use host::{HostServices, Request};
pub use injection::Misbehaviour;
pub use interpose::Exit;
pub use registers::Registers;
pub use scene::Scene;
pub(crate) use ticks::ticks;
pub use trap::Trap;
pub use watch::CallLimit;

use host::HostSide;
use loss::Loss;
use serve::{Input, What, Yielded, serve};
use stack::ComponentStack;
use trap::{Ended, Frame};

/// Room at the base of every component stack for the trap function, which starts there: it must
/// not overwrite the component's frames, because threads of the component may still use them.
const TRAP_ROOM_BYTES: usize = 4096;

type ComponentCoroutine = Coroutine<Input, Yielded, Ended, ComponentStack>;

/// One component instance behind the guard.
pub struct Guarded {
    /// `None` once the component has trapped or left.
    coroutine: Option<ComponentCoroutine>,
    /// Leaked when the instance is quarantined: threads of the component may still name it.
    frame: Box<Frame>,
    side: Box<HostSide>,
    stray: &'static stray::Word,
}

// SAFETY: between callbacks the coroutine is suspended in `serve`, whose frame holds nothing that
// is bound to a thread; the instance itself is entered by one thread at a time (contract of
// `Component` in the SDK and of the header).
unsafe impl Send for Guarded {}

impl Guarded {
    /// Prepares a stack for an instance of the component with these callbacks. Nothing of it runs
    /// yet. `component` is told when a thread is lost inside it.
    ///
    /// # Errors
    /// If the stack cannot be mapped.
    pub fn new(callbacks: Callbacks, code: CodeRange, component: u32) -> io::Result<Self> {
        trap::install();
        let stack = ComponentStack::new()?;
        let side = Box::new(HostSide::new(&stack));
        let side_pointer: *const HostSide = &raw const *side;
        let coroutine = ComponentCoroutine::with_stack(stack, move |yielder, first| {
            let room = [0u8; TRAP_ROOM_BYTES];
            black_box(&room);
            // SAFETY: the host side is boxed and outlives the coroutine, or is leaked with it.
            let ended = serve(unsafe { &*side_pointer }, &callbacks, yielder, first);
            black_box(&room);
            ended
        });
        let frame = Box::new(Frame {
            trap: coroutine.trap_handler(),
            limit: side.limit(),
            code,
            loss: ptr::null(),
            outer: ptr::null(),
            component,
            context: side_pointer,
        });
        Ok(Self {
            coroutine: Some(coroutine),
            frame,
            side,
            stray: stray::claim(code),
        })
    }

    /// Gives the process the handlers without which a fault in it is not survived. Instances do that
    /// themselves.
    pub fn prepare_process() {
        trap::install();
    }

    /// The fault that a thread of the component's own has met, once; the instance is quarantined.
    #[inline]
    pub fn take_stray_fault(&mut self) -> Option<Trap> {
        let trap = self.look_for_stray_fault()?;
        self.quarantine();
        Some(trap)
    }

    /// The same, for somebody who decides elsewhere what becomes of the instance.
    #[inline]
    pub fn look_for_stray_fault(&mut self) -> Option<Trap> {
        self.stray.take()
    }

    /// Gives the calling thread what the trap handler needs. Must be done once by every thread
    /// that calls components.
    ///
    /// # Errors
    /// If the system refuses an alternate signal stack.
    pub fn prepare_thread() -> io::Result<()> {
        trap::prepare_thread()
    }

    /// How many components the calling thread is inside of, one called by the other.
    pub fn call_depth() -> usize {
        trap::depth()
    }

    /// Whether the instance can still be called.
    pub fn is_alive(&self) -> bool {
        self.coroutine.is_some()
    }

    /// Runs a callback to its end; host services that it asks for are answered by `services`.
    /// `loss` is where this thread leaves word of what it is in, and if it is lost inside. After
    /// `limit` the watchdog breaks the callback off, if one watches over `loss`.
    #[inline]
    pub fn call<Services: HostServices>(
        &mut self,
        callback: Callback,
        limit: CallLimit,
        loss: &Loss,
        services: &mut Services,
    ) -> Ending {
        let Some(coroutine) = &mut self.coroutine else {
            return Ending::Gone;
        };
        self.frame.loss = loss;
        self.frame.outer = trap::current();
        trap::set_current(&raw const *self.frame);
        let services: *mut Services = services;
        self.side.set_services(services);
        let mut input = match callback {
            injected if self.side.has_injection() => {
                self.side.set_callback(injected);
                Input::Injected
            }
            Callback::Execute => Input::Execute,
            Callback::Updated => Input::Updated,
            other => {
                self.side.set_callback(other);
                Input::Callback
            }
        };
        let watched = loss.watch().enter(limit);
        let ending = loop {
            match coroutine.resume(input) {
                CoroutineResult::Yield(yielded) => match yielded.what {
                    What::Returned => break Ending::Returned(yielded.status),
                    What::Asked => {
                        // SAFETY: the component is suspended, so nobody else uses the services.
                        let services = unsafe { &mut *services };
                        loss.watch().pause(&watched);
                        self.side.set_reply(services.answer(self.side.request()));
                        loss.watch().resume(&watched);
                        input = Input::Reply;
                    }
                    What::Left => break Ending::Left(self.side.exit()),
                },
                CoroutineResult::Return(Ended::Trapped(trap)) => break Ending::Trapped(trap),
                CoroutineResult::Return(Ended::Asked) => break Ending::Gone,
            }
        };
        loss.watch().leave(watched);
        trap::set_current(self.frame.outer);
        if !matches!(ending, Ending::Returned(_)) {
            self.quarantine();
        }
        ending
    }

    /// Lets the component misbehave when its next callback is due, whichever that is; `None` takes
    /// that back. It happens once.
    pub fn inject(&mut self, misbehaviour: Option<Misbehaviour>) {
        self.side.set_injection(misbehaviour);
    }

    /// Sees to it that the first callbacks need not wait for pages of its stack and its code.
    pub fn touch_memory(&self) {
        self.side.stack().touch();
        self.frame.code.touch();
    }

    /// When it misbehaved last as it was made to, just before that: what benchmarks count from.
    pub fn misbehaved(&self) -> Option<Instant> {
        self.side.misbehaved.get()
    }

    /// From now on what callbacks allocate and do not free is counted.
    pub fn count_allocations(&mut self) {
        self.side.count_allocations();
    }

    /// Bytes that callbacks have allocated and not freed since counting began or
    /// [`Self::forget_allocations`]; 0 if they have freed more.
    #[inline]
    pub fn allocated_bytes(&self) -> u64 {
        self.side.allocated_bytes()
    }

    /// What was allocated so far does not count any more.
    pub fn forget_allocations(&mut self) {
        self.side.forget_allocations();
    }

    /// Where this instance was when `trap` hit it; `None` while it can still be called.
    pub fn scene(&self, trap: &Trap) -> Option<Scene> {
        (!self.is_alive()).then(|| Scene::new(self.frame.code, self.side.stack(), trap))
    }

    /// Never call this instance again; what it holds stays as it is. Also for an instance whose
    /// thread was lost inside it.
    pub fn quarantine(&mut self) {
        if let Some(coroutine) = self.coroutine.take() {
            mem::forget(coroutine);
        }
    }
}

impl Drop for Guarded {
    fn drop(&mut self) {
        match self.coroutine.take() {
            Some(mut coroutine) if coroutine.started() => {
                // Suspended in `serve` between two callbacks: only code of ours runs.
                let _ended = coroutine.resume(Input::End);
            }
            Some(_never_started) => {}
            None => {
                let quarantined = Box::new(HostSide::empty());
                mem::forget(mem::replace(&mut self.side, quarantined));
            }
        }
    }
}
