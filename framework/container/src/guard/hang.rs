//! Breaking out of a hang: the watchdog interrupts the lane's thread, again and again, until the
//! condemned callback can be taken off or must be given up (ARCHITECTURE, 'The guard').
//!
//! The handler keeps to the rules of `trap`'s.

use std::mem;
use std::ptr;
use std::sync::OnceLock;

use super::code::{CodeRange, LoadedObject};
use super::registers;
use super::trap::{self, Trap};

/// So often a condemned callback is met running outside the component's code before its thread is
/// given up. The interruptions are 1 ms apart; a loop that does little but allocate is back in its
/// own code within tens of them, and whoever is stopped in the allocator keeps its lock for ever.
const PATIENCE: u32 = 1000;

/// Who waits in a system call is interrupted there every time, and seldom comes back: so many
/// times as much does that count.
const WEIGHT_OF_WAITING: u32 = 20;

/// The container's own code: a component that is in it is about to ask or to return.
static OWN_CODE: OnceLock<CodeRange> = OnceLock::new();

/// Real-time signals are for applications; the C library keeps the first two, and a number in the
/// middle is less likely to be another library's.
pub(super) fn signal() -> libc::c_int {
    libc::SIGRTMIN() + 5
}

/// Interrupts a thread of this process; if it is in a condemned callback it is taken out of it. A
/// thread that has ended is no error: a number that was given away again gets a signal that means
/// nothing to it.
pub fn interrupt(thread: i32) {
    let process = std::process::id();
    // SAFETY: sends a signal whose handler ends nothing that is not condemned.
    unsafe { libc::syscall(libc::SYS_tgkill, process, thread, signal()) };
}

/// Installs the handler. Called once a process.
pub(super) fn install() {
    let own = LoadedObject::around(handle as *const () as usize).map(|program| program.code);
    // A second call would set the same.
    let _set_before = OWN_CODE.set(own.unwrap_or(CodeRange { start: 0, end: 0 }));
    // SAFETY: an all-zero action is a valid one; the fields that matter are set below.
    let mut action: libc::sigaction = unsafe { mem::zeroed() };
    // Interrupted calls of a component that is given time go on where the kernel lets them.
    action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK | libc::SA_RESTART;
    action.sa_sigaction = handle as *const () as usize;
    // SAFETY: the handler keeps to what a signal handler may do (module text).
    unsafe { libc::sigaction(signal(), &raw const action, ptr::null_mut()) };
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
    // SAFETY: null, or the frame of a call that is under way on this thread.
    let Some(frame) = (unsafe { trap::current().as_ref() }) else {
        return;
    };
    // SAFETY: the loss outlives every frame that names it (contract of `Frame`).
    let loss = unsafe { &*frame.loss };
    let Some(inside) = loss.watch().condemned() else {
        return;
    };
    let registers = registers::interrupted(context);
    let instruction_pointer = registers.instruction_pointer;
    // SAFETY: the host side outlives the call.
    let is_answering = unsafe { &*frame.context }.is_answering();
    if !frame.trap.stack_ptr_in_bounds(registers.stack_pointer) || is_answering {
        // A host call: it ends by itself.
        return;
    }
    let trap = Trap {
        signal,
        code: information.si_code,
        address: 0,
        registers,
        stack_overflow: false,
        hang: Some(inside.limit.duration()),
    };
    if frame.is_own_code(instruction_pointer) {
        trap::take_off(frame, trap, context);
    } else if is_ours(instruction_pointer) {
        // On its way into the container or out of it.
    } else {
        let weight = if registers::is_in_system_call(instruction_pointer) {
            WEIGHT_OF_WAITING
        } else {
            1
        };
        if loss.watch().refuse(weight) >= PATIENCE {
            loss.publish_and_park(frame, trap);
        }
    }
}

fn is_ours(instruction_pointer: usize) -> bool {
    OWN_CODE
        .get()
        .is_some_and(|own| own.contains(instruction_pointer))
}
