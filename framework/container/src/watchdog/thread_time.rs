//! How much of a time a thread has spent, or been kept waiting by others than itself.
//!
//! Nothing here allocates: a thread that was lost in the allocator may hold its lock for ever.

use std::io::Write as _;
use std::time::Duration;

use nix::time::{ClockId, clock_gettime};

/// What a thread has spent of the time that passed until now, in which its processor time went from
/// `before` to `now`, or began earlier: while it runs or is ready to run only what it ran, while it
/// sleeps all.
pub(super) fn spent(
    thread: i32,
    before: Option<Duration>,
    now: Option<Duration>,
    passed: Duration,
) -> Duration {
    let (Some(now), Some(before)) = (now, before) else {
        return Duration::ZERO;
    };
    let ran = now.saturating_sub(before).min(passed);
    if ran >= passed / 2 || is_ready(thread) {
        ran
    } else {
        passed
    }
}

/// The processor time of a thread; none of one that has ended.
pub(super) fn processor_time(thread: i32) -> Option<Duration> {
    /// The kernel's number for "this thread's clock, as the scheduler counts".
    const THREAD_CLOCK: i32 = 0b110;
    let clock = ClockId::from_raw((!thread << 3) | THREAD_CLOCK);
    clock_gettime(clock).ok().map(Duration::from)
}

/// Whether the thread runs or waits for a processor; what cannot be read counts as asleep.
fn is_ready(thread: i32) -> bool {
    // "/proc/self/task/<ten digits>/stat" and its end.
    let mut path = [0u8; 48];
    if write!(path.as_mut_slice(), "/proc/self/task/{thread}/stat\0").is_err() {
        return false;
    }
    // The state is the first letter behind the name, which is 15 bytes at most.
    let mut text = [0u8; 64];
    let flags = rustix::fs::OFlags::RDONLY | rustix::fs::OFlags::CLOEXEC;
    let read = std::ffi::CStr::from_bytes_until_nul(&path)
        .ok()
        .and_then(|path| rustix::fs::open(path, flags, rustix::fs::Mode::empty()).ok())
        .and_then(|file| rustix::io::read(&file, &mut text).ok());
    let text = &text[..read.unwrap_or(0)];
    let state = text
        .iter()
        .rposition(|letter| *letter == b')')
        .and_then(|end| text.get(end + 2));
    state == Some(&b'R')
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    #[test]
    fn a_thread_that_sleeps_spends_all_one_that_is_gone_nothing() {
        let (tell, told) = mpsc::channel();
        let (end, ended) = mpsc::channel::<()>();
        let sleeper = std::thread::spawn(move || {
            let thread = rustix::thread::gettid().as_raw_nonzero().get();
            tell.send(thread).expect("the test listens");
            let _dropped = ended.recv();
        });
        let thread = told.recv().expect("the thread tells");
        while is_ready(thread) {
            std::thread::yield_now();
        }
        let passed = Duration::from_secs(1);
        let before = processor_time(thread);
        let since = |thread, before| spent(thread, before, processor_time(thread), passed);
        assert_eq!(
            since(thread, None),
            Duration::ZERO,
            "nothing to compare with"
        );
        assert_eq!(since(thread, before), passed);
        let own = rustix::thread::gettid().as_raw_nonzero().get();
        let own_before = processor_time(own);
        assert!(since(own, own_before) < passed, "it does not sleep");
        drop(end);
        sleeper.join().expect("it ends");
        assert_eq!(processor_time(thread), None);
        assert_eq!(since(thread, before), Duration::ZERO);
    }
}
