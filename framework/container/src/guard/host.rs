//! The component's way into the container: what it asks, and who answers.
//!
//! Most functions suspend the coroutine with a request; the executor's side answers it on its own
//! stack. Reading, writing and the clock are answered at once, on the component's stack: they are
//! asked several times a cycle, hold no lock, and touch only this component's ends of its
//! connections, so that being cut off in the middle harms nobody else. (A switch there and back
//! costs two mispredicted returns, more than the answer itself.)

use std::cell::{Cell, UnsafeCell};
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering, compiler_fence};
use std::time::Instant;

use component_abi::{HostContext, Instance, Status};
use corosensei::Yielder;
use corosensei::stack::Stack as _;

use super::callback::Callback;
use super::foreign::{ForeignBytes, ForeignBytesMut, ForeignText};
use super::serve::{Input, What, Yielded};
use super::stack::{ComponentStack, StackMemory};
use super::{Exit, Misbehaviour};

/// What a component asks. Pointers are as the component gave them: anything.
#[derive(Debug, Clone, Copy)]
pub enum Request {
    /// Next datum of an input.
    Read(u32, ForeignBytesMut),
    /// A datum for an output.
    Write(u32, ForeignBytes),
    /// An event for an output.
    Raise(u32, ForeignBytes),
    /// Port, method, request, reply, deadline in nanoseconds.
    Call(u32, u32, ForeignBytes, ForeignBytesMut, u64),
    /// Name, value, place for its length.
    Property(ForeignText, ForeignBytesMut, ForeignBytesMut),
    /// The clock.
    Now,
    /// Level and message.
    Log(u32, ForeignText),
    /// Registers memory.
    Critical(*mut u8, usize),
    /// A fault that the component found itself.
    ReportFault(Status, ForeignText),
    /// Why the callback is about to fail: message, file, line, column.
    Failed(ForeignText, ForeignText, u32, u32),
    /// Name, place for the descriptor.
    OpenDevice(ForeignText, ForeignBytesMut),
}

/// Answers what components ask; the answer is a status code, or the time for [`Request::Now`].
pub trait HostServices {
    /// Answers one request: on the component's stack for reading, writing and the clock, on the
    /// container's for all else. (By reference: the fields were just
    /// written one by one, and a copy would wait for all of them.)
    fn answer(&mut self, request: &Request) -> u64;

    /// Whether the data that an input reads wait in a queue, each to be read once.
    fn has_queue(&self, _port: u32) -> bool {
        false
    }
}

/// Answers a request on behalf of the services behind the pointer.
pub(super) type Answer = unsafe fn(*mut (), &Request) -> u64;

/// What an instance's host context points to.
pub(super) struct HostSide {
    yielder: Cell<*const Yielder<Input, Yielded>>,
    instance: Cell<*mut Instance>,
    callback: Cell<Callback>,
    /// Written by the component's side before it suspends, read by the container's side before it
    /// resumes: never both at once.
    request: UnsafeCell<Request>,
    reply: Cell<u64>,
    /// Who answers during this call, and how.
    services: Cell<*mut ()>,
    answer: Cell<Answer>,
    /// Set while a request is answered on the component's stack: then the component must not be
    /// taken off, though the stack is its own.
    answering: AtomicBool,
    /// What happens at the next callback.
    injection: Cell<Option<Misbehaviour>>,
    /// When that happened.
    pub(super) misbehaved: Cell<Option<Instant>>,
    /// Whether the component has tried to change signals that the guard needs.
    meddled: Cell<bool>,
    exit: Cell<Exit>,
    /// Whether allocations are counted.
    counts: Cell<bool>,
    /// Bytes allocated by callbacks less bytes freed by them. Goes round: of both an unlimited
    /// number may pass, and memory that was allocated before may be freed.
    allocated: Cell<usize>,
    base: usize,
    limit: usize,
}

impl HostSide {
    pub(super) fn new(stack: &ComponentStack) -> Self {
        Self {
            base: stack.base().get(),
            limit: stack.limit().get(),
            ..Self::empty()
        }
    }

    /// Stands in for a host side that was leaked.
    pub(super) fn empty() -> Self {
        Self {
            yielder: Cell::new(ptr::null()),
            instance: Cell::new(ptr::null_mut()),
            callback: Cell::new(Callback::Create),
            request: UnsafeCell::new(Request::Now),
            reply: Cell::new(0),
            services: Cell::new(ptr::null_mut()),
            answer: Cell::new(answer_nothing),
            answering: AtomicBool::new(false),
            injection: Cell::new(None),
            misbehaved: Cell::new(None),
            meddled: Cell::new(false),
            exit: Cell::new(Exit::Abort),
            counts: Cell::new(false),
            allocated: Cell::new(0),
            base: 0,
            limit: 0,
        }
    }

    pub(super) fn limit(&self) -> usize {
        self.limit
    }

    pub(super) fn stack(&self) -> StackMemory {
        StackMemory {
            limit: self.limit,
            base: self.base,
        }
    }

    pub(super) fn context(&self) -> *mut HostContext {
        ptr::from_ref(self).cast_mut().cast()
    }

    pub(super) fn set_yielder(&self, yielder: &Yielder<Input, Yielded>) {
        self.yielder.set(yielder);
    }

    pub(super) fn instance(&self) -> *mut Instance {
        self.instance.get()
    }

    pub(super) fn set_instance(&self, instance: *mut Instance) {
        self.instance.set(instance);
    }

    /// Whether the caller runs on this component's own stack: threads of the component's own may
    /// hold the context, but may not suspend a coroutine that they are not inside of.
    pub(super) fn called_on_own_stack(&self) -> bool {
        let here = 0u8;
        let address = (&raw const here).addr();
        (self.limit..self.base).contains(&address)
    }

    pub(super) fn callback(&self) -> Callback {
        self.callback.get()
    }

    pub(super) fn set_callback(&self, callback: Callback) {
        self.callback.set(callback);
    }

    /// Whether it has been called before.
    pub(super) fn has_meddled(&self) -> bool {
        self.meddled.replace(true)
    }

    pub(super) fn set_injection(&self, misbehaviour: Option<Misbehaviour>) {
        self.injection.set(misbehaviour);
    }

    #[inline]
    pub(super) fn has_injection(&self) -> bool {
        self.injection.get().is_some()
    }

    pub(super) fn take_injection(&self) -> Option<Misbehaviour> {
        self.injection.take()
    }

    pub(super) fn count_allocations(&self) {
        self.counts.set(true);
    }

    /// Whether what the caller allocates is this component's: not what a request allocates that is
    /// answered here.
    #[inline]
    pub(super) fn counts_allocations(&self) -> bool {
        self.counts.get() && !self.is_answering() && self.called_on_own_stack()
    }

    #[inline]
    pub(super) fn charge(&self, freed: usize, allocated: usize) {
        let before = self.allocated.get();
        self.allocated
            .set(before.wrapping_sub(freed).wrapping_add(allocated));
    }

    pub(super) fn allocated_bytes(&self) -> u64 {
        let net = self.allocated.get().cast_signed();
        u64::try_from(net).unwrap_or(0)
    }

    pub(super) fn forget_allocations(&self) {
        self.allocated.set(0);
    }

    pub(super) fn request(&self) -> &Request {
        // SAFETY: the component is suspended while the container looks at what it asks.
        unsafe { &*self.request.get() }
    }

    pub(super) fn set_reply(&self, reply: u64) {
        self.reply.set(reply);
    }

    pub(super) fn exit(&self) -> Exit {
        self.exit.get()
    }

    /// Names who answers from now on. The services must stay where they are, and untouched while
    /// the component runs, until the call is over.
    #[inline]
    pub(super) fn set_services<Services: HostServices>(&self, services: *mut Services) {
        /// # Safety
        /// `services` must point to live `Services` that nobody else uses now.
        unsafe fn answer<Services: HostServices>(services: *mut (), request: &Request) -> u64 {
            // SAFETY: by this function's contract.
            unsafe { &mut *services.cast::<Services>() }.answer(request)
        }
        self.services.set(services.cast());
        self.answer.set(answer::<Services>);
    }

    /// Answers without leaving the component's stack.
    #[inline]
    pub(super) fn answer_here(&self, request: &Request) -> u64 {
        if !self.called_on_own_stack() {
            return u64::from(Status::UNAUTHORIZED.0);
        }
        let answer = self.answer.get();
        self.answering.store(true, Ordering::Relaxed);
        // Who looks is a signal handler on this very thread: only the compiler must keep the order.
        compiler_fence(Ordering::SeqCst);
        // SAFETY: set by the call that is under way (we are on this component's stack), which
        // does not touch the services while the component runs.
        let reply = unsafe { answer(self.services.get(), request) };
        compiler_fence(Ordering::SeqCst);
        self.answering.store(false, Ordering::Relaxed);
        reply
    }

    /// Whether a request is being answered on the component's stack. Called inside the handler.
    pub(super) fn is_answering(&self) -> bool {
        self.answering.load(Ordering::Relaxed)
    }

    #[inline]
    pub(super) fn ask(&self, request: Request) -> u64 {
        if !self.called_on_own_stack() {
            return u64::from(Status::UNAUTHORIZED.0);
        }
        // SAFETY: the container looks at it only while this coroutine is suspended.
        unsafe { *self.request.get() = request };
        self.suspend(What::Asked);
        self.reply.get()
    }

    /// Leaves the component for good, if called on its stack: it is never resumed.
    pub(super) fn leave(&self, exit: Exit) {
        if self.called_on_own_stack() {
            self.exit.set(exit);
            loop {
                self.suspend(What::Left);
            }
        }
    }

    #[inline]
    fn suspend(&self, what: What) {
        // SAFETY: set at the start of the coroutine, lives at the base of the stack we are on.
        let yielder = unsafe { &*self.yielder.get() };
        // What comes back is always a reply; a component that left is never resumed.
        let _reply = yielder.suspend(Yielded {
            what,
            status: Status::SUCCESS,
        });
    }
}

/// Before the first call.
unsafe fn answer_nothing(_services: *mut (), _request: &Request) -> u64 {
    u64::from(Status::UNAUTHORIZED.0)
}
