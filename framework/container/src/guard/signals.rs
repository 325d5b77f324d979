//! `sigaction`, `signal`, `sigprocmask` and `pthread_sigmask`, defined in the executable so that
//! components bind to them first. On a component's stack the signals that the guard lives by keep
//! their handlers and stay unblocked: the component is told that all went well, and a warning in
//! its name is put on record, once. Everything else, and everybody else, gets what they always did.
//!
//! A component that makes the system call itself, or does it in a thread of its own, is not held
//! back. An executable that loads components must export these symbols; see `exported_symbols.rs`.

use std::mem;
use std::ptr;
use std::sync::atomic::{AtomicPtr, Ordering};

use component_abi::Text;
use libc::{c_int, sighandler_t, sigset_t};

use super::copy::guarded_copy;
use super::foreign::ForeignText;
use super::hang;
use super::host::{HostSide, Request};
use super::{interpose, trap};

/// The kernel's set of signals: one bit each, signal 1 the lowest.
type KernelSet = u64;

/// The two signals that the C library keeps for itself; it takes them out of every mask.
const OF_THE_LIBRARY: KernelSet = bit(32) | bit(33);

/// Level of the record: see `Services::log`.
const WARNING: u32 = 2;

const fn bit(signal: c_int) -> KernelSet {
    1 << (signal - 1)
}

fn guarded_set() -> KernelSet {
    let fatal = trap::SIGNALS.iter().fold(0, |set, one| set | bit(*one));
    fatal | bit(hang::signal())
}

/// Whether the guard lives by a signal; numbers that are none are for the kernel to refuse.
fn is_guarded(signal: c_int) -> bool {
    (1..=64).contains(&signal) && guarded_set() & bit(signal) != 0
}

/// The host side of the component on whose stack the caller runs.
fn component() -> Option<&'static HostSide> {
    // SAFETY: null, or the frame of a call that is under way on this thread.
    let frame = unsafe { trap::current().as_ref() }?;
    // SAFETY: the host side outlives the call, and so all that happens on this stack.
    let side = unsafe { &*frame.context };
    side.called_on_own_stack().then_some(side)
}

/// The record of a refusal: a text of the program, because nothing may be allocated here that a
/// component cut off would never free.
macro_rules! refusal {
    ($function:literal) => {
        concat!(
            $function,
            ": signals that the guard needs keep their handlers and stay unblocked"
        )
    };
}

/// Puts on record that a component meddled, once.
fn refuse(side: &HostSide, message: &'static str) {
    if !side.has_meddled() {
        let text = Text {
            data: message.as_ptr(),
            length: message.len(),
        };
        side.ask(Request::Log(WARNING, ForeignText::new(text)));
    }
}

/// As `sigaction(2)`, except on a component's stack.
///
/// # Safety
/// As the C library's: pointers are null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sigaction(
    signal: c_int,
    action: *const libc::sigaction,
    old: *mut libc::sigaction,
) -> c_int {
    let mut action = action;
    if !action.is_null()
        && is_guarded(signal)
        && let Some(side) = component()
    {
        refuse(side, refusal!("sigaction"));
        action = ptr::null();
    }
    // SAFETY: by this function's contract; null only asks.
    unsafe { library_sigaction(signal, action, old) }
}

/// As `signal(2)` of the C library, except on a component's stack.
///
/// # Safety
/// As the C library's: `handler` is `SIG_DFL`, `SIG_IGN` or a function for signals.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn signal(signal: c_int, handler: sighandler_t) -> sighandler_t {
    // SAFETY: an all-zero action is a valid one.
    let mut new: libc::sigaction = unsafe { mem::zeroed() };
    new.sa_sigaction = handler;
    new.sa_flags = libc::SA_RESTART;
    // SAFETY: as above.
    let mut old: libc::sigaction = unsafe { mem::zeroed() };
    // SAFETY: both are ours; the handler by this function's contract.
    match unsafe { sigaction(signal, &raw const new, &raw mut old) } {
        0 => old.sa_sigaction,
        _ => libc::SIG_ERR,
    }
}

/// As `sigprocmask(2)`, except on a component's stack.
///
/// # Safety
/// As the C library's: pointers are null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sigprocmask(
    how: c_int,
    set: *const sigset_t,
    old: *mut sigset_t,
) -> c_int {
    change_mask(refusal!("sigprocmask"), how, set, old)
}

/// As `pthread_sigmask(3)`, except on a component's stack.
///
/// # Safety
/// As the C library's: pointers are null or valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pthread_sigmask(
    how: c_int,
    set: *const sigset_t,
    old: *mut sigset_t,
) -> c_int {
    match change_mask(refusal!("pthread_sigmask"), how, set, old) {
        0 => 0,
        _ => std::io::Error::last_os_error()
            .raw_os_error()
            .unwrap_or(libc::EINVAL),
    }
}

/// The system call, with what must not be blocked taken out of the set.
fn change_mask(
    refusal: &'static str,
    how: c_int,
    set: *const sigset_t,
    old: *mut sigset_t,
) -> c_int {
    let mut mask: KernelSet = 0;
    // Before the handlers are installed only the container's own threads ask, whose sets are valid;
    // null must not be touched even then.
    let is_readable = !set.is_null()
        // SAFETY: the mask is ours; the set may be anything.
        && unsafe { guarded_copy((&raw mut mask).cast(), set.cast(), size_of::<KernelSet>()) };
    if how != libc::SIG_UNBLOCK {
        mask &= !OF_THE_LIBRARY;
        if mask & guarded_set() != 0
            && let Some(side) = component()
        {
            refuse(side, refusal);
            mask &= !guarded_set();
        }
    }
    // A set that is not readable is for the kernel to refuse; none at all only asks.
    let set = if is_readable {
        &raw const mask
    } else {
        set.cast()
    };
    // SAFETY: the kernel checks the pointers; sets of the library begin with the kernel's.
    let result = unsafe {
        libc::syscall(
            libc::SYS_rt_sigprocmask,
            how,
            set,
            old,
            size_of::<KernelSet>(),
        )
    };
    if result == 0 { 0 } else { -1 }
}

/// The C library's own `sigaction`. Looked up once, which the start of every Rust program does;
/// then it is fit for handlers and for the child of a fork.
///
/// # Safety
/// As the C library's.
unsafe fn library_sigaction(
    signal: c_int,
    action: *const libc::sigaction,
    old: *mut libc::sigaction,
) -> c_int {
    type Sigaction =
        unsafe extern "C" fn(c_int, *const libc::sigaction, *mut libc::sigaction) -> c_int;
    static FUNCTION: AtomicPtr<libc::c_void> = AtomicPtr::new(ptr::null_mut());
    let mut function = FUNCTION.load(Ordering::Acquire);
    if function.is_null() {
        function = interpose::next(c"sigaction");
        if function.is_null() {
            return -1;
        }
        FUNCTION.store(function, Ordering::Release);
    }
    // SAFETY: the C library's function of this name has this type.
    let function: Sigaction = unsafe { mem::transmute(function) };
    // SAFETY: by this function's contract.
    unsafe { function(signal, action, old) }
}
