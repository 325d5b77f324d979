//! The least that a trap can cost: a coroutine traps, a handler that asks nothing makes it return.
//! What the guard does beyond that is measured against it.
//!
//! It takes the place of the guard's own handler, so it belongs in a process that runs no component.

use std::cell::Cell;
use std::io;
use std::mem;
use std::ptr;

use corosensei::trap::CoroutineTrapHandler;
use corosensei::{Coroutine, CoroutineResult};

use super::injection::read_null;
use super::registers;
use super::stack::ComponentStack;
use super::trap::prepare_thread;

type BareCoroutine = Coroutine<(), (), bool, ComponentStack>;

thread_local! {
    // Const-initialised and without a destructor, so that the handler may read it.
    static TRAPPING: Cell<Option<CoroutineTrapHandler<bool>>> = const { Cell::new(None) };
}

/// Traps again and again, without a guard.
pub struct BareTrap {
    coroutine: BareCoroutine,
}

impl BareTrap {
    /// Puts a bare handler in the place of any other one for `SIGSEGV` in this process, and
    /// prepares the calling thread for it.
    ///
    /// # Errors
    /// If the system refuses a stack or the handler.
    pub fn install() -> io::Result<Self> {
        prepare_thread()?;
        // SAFETY: an all-zero action is a valid one; the fields that matter are set below.
        let mut action: libc::sigaction = unsafe { mem::zeroed() };
        action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK | libc::SA_NODEFER;
        action.sa_sigaction = handle as *const () as usize;
        // SAFETY: the handler allocates nothing and takes no lock.
        let result = unsafe { libc::sigaction(libc::SIGSEGV, &raw const action, ptr::null_mut()) };
        if result != 0 {
            return Err(io::Error::last_os_error());
        }
        let coroutine = trapping_coroutine(ComponentStack::new()?);
        Ok(Self { coroutine })
    }

    /// Runs into a null pointer and comes back; whether it came back by way of the trap. Not done
    /// twice by one value: [`Self::renewed`] makes another one of it.
    #[inline]
    pub fn round_trip(&mut self) -> bool {
        TRAPPING.set(Some(self.coroutine.trap_handler()));
        matches!(self.coroutine.resume(()), CoroutineResult::Return(true))
    }

    /// One that can trap again, on the same stack, of one that has trapped.
    pub fn renewed(self) -> Self {
        let stack = self.coroutine.into_stack();
        Self {
            coroutine: trapping_coroutine(stack),
        }
    }
}

fn trapping_coroutine(stack: ComponentStack) -> BareCoroutine {
    BareCoroutine::with_stack(stack, |_yielder, ()| {
        read_null();
        false
    })
}

extern "C" fn handle(
    _signal: libc::c_int,
    _information: *mut libc::siginfo_t,
    context: *mut libc::c_void,
) {
    // SAFETY: the kernel passes it for SA_SIGINFO handlers; the handler is the only user of it.
    let context = unsafe { &mut *context.cast::<libc::ucontext_t>() };
    let stack_pointer = registers::interrupted(context).stack_pointer;
    match TRAPPING.get() {
        Some(trap) if trap.stack_ptr_in_bounds(stack_pointer) => {
            // SAFETY: the stack pointer is inside the coroutine that this thread has resumed, which
            // holds nothing; the registers are set as demanded below.
            let registers = unsafe { trap.setup_trap_handler(|| true) };
            registers::redirect(context, &registers);
        }
        // SAFETY: allowed in signal handlers; the instruction traps again and ends the process.
        _ => unsafe {
            libc::signal(libc::SIGSEGV, libc::SIG_DFL);
        },
    }
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    /// Run by the test below in a process of its own, whose handlers are nobody else's.
    #[test]
    #[ignore = "takes the place of the guard's handler"]
    fn traps_and_returns() {
        let mut bare = BareTrap::install().expect("a stack and a handler");
        for _ in 0..100 {
            assert!(bare.round_trip());
            bare = bare.renewed();
        }
    }

    #[test]
    fn a_bare_trap_comes_back_again_and_again() {
        let mut test = Command::new(std::env::current_exe().expect("this test"));
        test.args([
            "--ignored",
            "--exact",
            "guard::bare_trap::tests::traps_and_returns",
        ]);
        let output = test.output().expect("the test runs");
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.contains("1 passed"), "{text}");
    }
}
