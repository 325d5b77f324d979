//! The trap handler: tells a component's fault from the container's and takes the component off
//! the processor without touching a frame of ours (ARCHITECTURE, 'The guard').
//!
//! It runs on an alternate stack inside a signal, so it allocates nothing, takes no lock, and reads
//! only memory that was prepared before the component was entered.

use std::cell::Cell;
use std::io;
use std::mem;
use std::ptr;
use std::sync::Once;
use std::time::Duration;

use corosensei::trap::CoroutineTrapHandler;

use super::allocation;
use super::code::CodeRange;
use super::copy;
use super::hang;
use super::heap;
use super::injection;
use super::loss::Loss;
use super::registers::{self, Registers};
use super::stack::ComponentStack;
use super::stray;

/// Size of the stack that the handler runs on: the signal frame with all vector registers takes
/// about 4 KiB, the handler little more; the rest is for safety.
const HANDLER_STACK_BYTES: usize = 64 * 1024;

/// The synchronous signals, and abort.
pub(super) const SIGNALS: [libc::c_int; 6] = [
    libc::SIGSEGV,
    libc::SIGBUS,
    libc::SIGFPE,
    libc::SIGILL,
    libc::SIGTRAP,
    libc::SIGABRT,
];

/// What the handler saw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trap {
    /// Signal number.
    pub signal: i32,
    /// `si_code`.
    pub code: i32,
    /// `si_addr`: the address that could not be accessed, or the faulting instruction.
    pub address: usize,
    /// Where the component was.
    pub registers: Registers,
    /// Whether the stack's guard area was hit.
    pub stack_overflow: bool,
    /// The limit that the callback did not keep, if the watchdog broke it off; then the signal is
    /// the watchdog's, and the instruction pointer tells where the component was.
    pub hang: Option<Duration>,
}

/// How a coroutine ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ended {
    /// The container asked for it.
    Asked,
    /// A trap took the component off.
    Trapped(Trap),
}

/// What the handler must know of the component that this thread is inside of.
pub(super) struct Frame {
    pub(super) trap: CoroutineTrapHandler<Ended>,
    pub(super) limit: usize,
    pub(super) code: CodeRange,
    pub(super) loss: *const Loss,
    /// The component that called a service of this one, on the same thread.
    pub(super) outer: *const Frame,
    pub(super) component: u32,
    /// Opaque to the handler: the host context, for calls that end the component from inside.
    pub(super) context: *const super::host::HostSide,
}

impl Frame {
    /// Whether an instruction is the component's own, or stands for one.
    pub(super) fn is_own_code(&self, instruction_pointer: usize) -> bool {
        self.code.contains(instruction_pointer) || injection::contains(instruction_pointer)
    }
}

thread_local! {
    // Const-initialised and without a destructor, so that the handler may read it.
    static CURRENT: Cell<*const Frame> = const { Cell::new(ptr::null()) };
    static HANDLER_STACK: Cell<bool> = const { Cell::new(false) };
}

/// The frame of the component that this thread is inside of; null outside.
#[inline]
pub(super) fn current() -> *const Frame {
    CURRENT.get()
}

/// How many frames there are, one inside the other.
pub(super) fn depth() -> usize {
    let mut depth = 0;
    let mut next = current();
    // SAFETY: null, or frames of calls that are under way on this thread.
    while let Some(frame) = unsafe { next.as_ref() } {
        depth += 1;
        next = frame.outer;
    }
    depth
}

/// Enters or leaves a component.
#[inline]
pub(super) fn set_current(frame: *const Frame) {
    CURRENT.set(frame);
}

/// Installs the handlers, once a process. Idempotent.
pub(super) fn install() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        for signal in SIGNALS {
            // SAFETY: an all-zero action is a valid one; the fields that matter are set below.
            let mut action: libc::sigaction = unsafe { mem::zeroed() };
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK | libc::SA_NODEFER;
            action.sa_sigaction = handle as *const () as usize;
            // SAFETY: the handler keeps to what a signal handler may do (module text).
            unsafe { libc::sigaction(signal, &raw const action, ptr::null_mut()) };
        }
        hang::install();
    });
}

/// Gives the calling thread a stack for the handler. Idempotent. The stack is leaked on purpose: a
/// thread that runs components may be parked inside the handler for ever.
pub(super) fn prepare_thread() -> io::Result<()> {
    if HANDLER_STACK.get() {
        return Ok(());
    }
    let memory = Box::leak(vec![0u8; HANDLER_STACK_BYTES].into_boxed_slice());
    let stack = libc::stack_t {
        ss_sp: memory.as_mut_ptr().cast(),
        ss_flags: 0,
        ss_size: memory.len(),
    };
    // SAFETY: the memory is leaked, so it outlives the thread.
    if unsafe { libc::sigaltstack(&raw const stack, ptr::null_mut()) } != 0 {
        return Err(io::Error::last_os_error());
    }
    HANDLER_STACK.set(true);
    Ok(())
}

extern "C" fn handle(
    signal: libc::c_int,
    information: *mut libc::siginfo_t,
    context: *mut libc::c_void,
) {
    // SAFETY: the kernel passes both for SA_SIGINFO handlers, valid for the time of the call.
    let information = unsafe { &*information };
    // SAFETY: as above; the handler is the only user of the context.
    let context = unsafe { &mut *context.cast::<libc::ucontext_t>() };
    let registers = registers::interrupted(context);
    let (instruction_pointer, stack_pointer) =
        (registers.instruction_pointer, registers.stack_pointer);
    if let Some(exit) = copy::fault_exit(instruction_pointer) {
        registers::jump(context, exit);
        return;
    }
    // SAFETY: null, or the frame of a call that is under way on this thread.
    let frame = unsafe { CURRENT.get().as_ref() };
    match frame {
        Some(frame)
            if frame.trap.stack_ptr_in_bounds(stack_pointer) && !sent_by_others(information) =>
        {
            let trap = record(signal, information, frame, registers);
            if frame.is_own_code(instruction_pointer) {
                take_off(frame, trap, context);
            } else {
                // In the C library or the loader: a lock may be held. The thread stops here for ever.
                // SAFETY: the loss outlives every frame that names it (contract of `Frame`).
                let loss = unsafe { &*frame.loss };
                if allocation::is_inside() {
                    loss.publish(frame, trap);
                    heap::end_process(frame.component);
                }
                loss.publish_and_park(frame, trap);
            }
        }
        _ if sent_by_others(information) => fail_container(signal, information),
        _ => match stray::culprit(instruction_pointer, stack_pointer) {
            Some(word) => {
                word.leave_and_park(signal, address(signal, information), instruction_pointer);
            }
            None => fail_container(signal, information),
        },
    }
}

/// Whether another process sent the signal with `kill`: that is meant for the container.
fn sent_by_others(information: &libc::siginfo_t) -> bool {
    if information.si_code != libc::SI_USER {
        return false;
    }
    // SAFETY: for SI_USER the kernel fills the sender's process id.
    let sender = unsafe { information.si_pid() };
    u32::try_from(sender) != Ok(std::process::id())
}

fn record(signal: i32, information: &libc::siginfo_t, frame: &Frame, registers: Registers) -> Trap {
    let address = address(signal, information);
    let overflow = matches!(signal, libc::SIGSEGV | libc::SIGBUS)
        && (ComponentStack::guard_contains(frame.limit, address)
            || ComponentStack::guard_contains(frame.limit, registers.stack_pointer));
    Trap {
        signal,
        code: information.si_code,
        address,
        registers,
        stack_overflow: overflow,
        hang: None,
    }
}

fn address(signal: i32, information: &libc::siginfo_t) -> usize {
    if signal == libc::SIGABRT {
        return 0;
    }
    // SAFETY: the kernel fills the address for the synchronous signals.
    unsafe { information.si_addr() as usize }
}

/// Makes the coroutine return `trap` when the handler returns.
pub(super) fn take_off(frame: &Frame, trap: Trap, context: &mut libc::ucontext_t) {
    // SAFETY: the stack pointer is inside this coroutine; the registers are set as demanded below.
    // The interrupted instruction is the component's own, so no host call of ours is cut off.
    let registers = unsafe { frame.trap.setup_trap_handler(move || Ended::Trapped(trap)) };
    registers::redirect(context, &registers);
    // The component may have blocked signals; the kernel restores this mask on return.
    // SAFETY: the mask is part of the context that is ours during the call.
    unsafe { libc::sigemptyset(&raw mut context.uc_sigmask) };
}

/// Not a component's fault: the default action ends the process, with a core dump where the
/// system writes one.
fn fail_container(signal: libc::c_int, information: &libc::siginfo_t) {
    // SAFETY: both calls are allowed in signal handlers.
    unsafe { libc::signal(signal, libc::SIG_DFL) };
    // What the processor raised comes again by itself when the handler returns; what somebody sent
    // (codes up to 0) does not.
    if information.si_code <= 0 {
        // SAFETY: as above.
        unsafe { libc::raise(signal) };
    }
}
