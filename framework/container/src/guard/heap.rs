//! A heap that a component has damaged: the C library noticed while it held the allocator's lock, and
//! all threads of the process share what is damaged. Whoever went on would stop at that lock sooner
//! or later, so the process ends soon, for its outer supervisor to start it anew.
#![allow(unsafe_code)] // ends the process from inside a signal handler

use std::io::Write as _;

/// Long enough for the fault to be judged and the event file to be written, by whom the lock does not
/// stop; short beside what a person or a supervisor takes to act.
static LAST_MOMENTS: libc::timespec = libc::timespec {
    tv_sec: 1,
    tv_nsec: 0,
};

/// Ends the process, with a core dump where the system writes one, after a moment in which others may
/// finish what they are at. Called inside the handler, by the thread that the fault has hit in the
/// allocator: allocates nothing.
pub(super) fn end_process(component: u32) -> ! {
    // SAFETY: the time is there; how much was left when a signal came is of no interest.
    unsafe { libc::nanosleep(&raw const LAST_MOMENTS, std::ptr::null_mut()) };
    let mut text = [0_u8; 400];
    let mut rest = &mut text[..];
    // It fits; else its beginning is written.
    let _cut = writeln!(
        rest,
        "steadfast: component {} of this run met a damaged heap, whose lock is held for ever now; \
         the container ends, because memory of all components may be damaged. \
         <isolation>process</isolation> would have contained this.",
        component + 1
    );
    let left = rest.len();
    let length = text.len() - left;
    // SAFETY: the bytes are there.
    unsafe { libc::write(libc::STDERR_FILENO, text.as_ptr().cast(), length) };
    // SAFETY: the default action ends the process.
    unsafe { libc::signal(libc::SIGABRT, libc::SIG_DFL) };
    loop {
        // SAFETY: sends a signal to this very thread.
        unsafe { libc::raise(libc::SIGABRT) };
        // SAFETY: no precondition.
        unsafe { libc::pause() };
    }
}
