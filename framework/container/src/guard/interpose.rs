//! `abort`, `exit`, `_exit` and `quick_exit`, defined in the executable so that components bind to
//! them first: called on a component's stack they end that component, elsewhere they do what they
//! always did. (Calls that the C library makes inside itself do not pass here; its `abort` after a
//! corrupted heap arrives as SIGABRT with the instruction pointer in the C library.)
//!
//! An executable that loads components must export these symbols; see `exported_symbols.rs`.

use std::ffi::CStr;

use super::trap;

/// How a component tried to end the process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// `abort()`.
    Abort,
    /// `exit(code)`, `_exit(code)` or `quick_exit(code)`.
    Exit(i32),
}

/// Ends the component that the caller runs inside of; returns if it runs in none.
fn end_component(exit: Exit) {
    // SAFETY: null, or the frame of a call that is under way on this thread.
    if let Some(frame) = unsafe { trap::current().as_ref() } {
        // SAFETY: the host side outlives the call.
        unsafe { &*frame.context }.leave(exit);
    }
}

/// The function of this name in the next library, that is, the C library.
pub(super) fn next(name: &CStr) -> *mut libc::c_void {
    // SAFETY: a look-up by a terminated name.
    unsafe { libc::dlsym(libc::RTLD_NEXT, name.as_ptr()) }
}

/// As `abort(3)`, except on a component's stack.
#[unsafe(no_mangle)]
pub extern "C" fn abort() -> ! {
    end_component(Exit::Abort);
    let function = next(c"abort");
    if !function.is_null() {
        // SAFETY: the C library's function of this name has this type.
        let function: extern "C" fn() = unsafe { std::mem::transmute(function) };
        function();
    }
    end_process(134)
}

/// As `exit(3)`, except on a component's stack.
#[unsafe(no_mangle)]
pub extern "C" fn exit(code: libc::c_int) -> ! {
    leave_by(c"exit", code)
}

/// As `quick_exit(3)`, except on a component's stack.
#[unsafe(no_mangle)]
pub extern "C" fn quick_exit(code: libc::c_int) -> ! {
    leave_by(c"quick_exit", code)
}

/// As `_exit(2)`, except on a component's stack.
#[unsafe(no_mangle)]
pub extern "C" fn _exit(code: libc::c_int) -> ! {
    end_component(Exit::Exit(code));
    end_process(code)
}

fn leave_by(name: &CStr, code: libc::c_int) -> ! {
    end_component(Exit::Exit(code));
    let function = next(name);
    if !function.is_null() {
        // SAFETY: the C library's function of this name has this type.
        let function: extern "C" fn(libc::c_int) = unsafe { std::mem::transmute(function) };
        function(code);
    }
    end_process(code)
}

/// The system call itself: the library function of that name is the one above.
fn end_process(code: libc::c_int) -> ! {
    loop {
        // SAFETY: ends the process; no precondition.
        unsafe { libc::syscall(libc::SYS_exit_group, code) };
    }
}
