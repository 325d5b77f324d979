//! A thread that was lost inside a component: the fault hit outside the component's own code (in
//! the C library's allocator, in the loader), where continuing could deadlock on a lock that is
//! held for ever. The thread stops inside the handler; another takes over its lane.

use std::cell::UnsafeCell;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use rustix::thread::futex;

use super::trap::{Frame, Trap};
use super::watch::Watch;

/// How many components can be inside one another by service calls on one thread; deeper chains are
/// refused when they are made.
pub const DEEPEST_CALL_CHAIN: usize = 8;

/// What is known of a lost thread.
#[derive(Debug, Clone, Copy)]
pub struct LostThread {
    /// What hit it.
    pub trap: Trap,
    /// The components that were inside, innermost first.
    pub components: [u32; DEEPEST_CALL_CHAIN],
    /// How many of them.
    pub depth: usize,
}

/// What a lane's thread leaves word of: which callback it is in, and when it is lost. At most one
/// loss is under way a lane: the thread that takes over clears it first.
#[derive(Default)]
pub struct Loss {
    watch: Watch,
    state: AtomicU32,
    record: UnsafeCell<Option<LostThread>>,
}

const NONE: u32 = 0;
const PUBLISHED: u32 = 1;

/// Counts all losses of the process: the spare thread sleeps on it.
static LOSSES: AtomicU32 = AtomicU32::new(0);

// SAFETY: `record` is written only by the thread that is being lost, before `state` becomes
// PUBLISHED with release order, and read only after that was seen with acquire order.
unsafe impl Sync for Loss {}

impl Loss {
    /// What the lane's thread is in, for the watchdog.
    #[inline]
    pub fn watch(&self) -> &Watch {
        &self.watch
    }

    /// Takes the record of a lost thread, if there is one.
    pub fn take(&self) -> Option<LostThread> {
        if self.state.load(Ordering::Acquire) != PUBLISHED {
            return None;
        }
        // SAFETY: published, and the lost thread never runs again; see the `Sync` argument.
        let record = unsafe { *self.record.get() };
        self.watch.reset();
        self.state.store(NONE, Ordering::Release);
        record
    }

    /// Publishes the loss of this thread and stops for ever. Called inside the handler.
    pub(super) fn publish_and_park(&self, frame: &Frame, trap: Trap) -> ! {
        self.publish(frame, trap);
        loop {
            // SAFETY: no precondition; returns after a signal was handled.
            unsafe { libc::pause() };
        }
    }

    /// Publishes the loss of this thread, which then leaves its lane alone. Called inside the
    /// handler.
    pub(super) fn publish(&self, frame: &Frame, trap: Trap) {
        let mut lost = LostThread {
            trap,
            components: [0; DEEPEST_CALL_CHAIN],
            depth: 0,
        };
        let mut next = std::ptr::from_ref(frame);
        // SAFETY: frames of calls that are under way on this thread, linked innermost first.
        while let Some(inside) = unsafe { next.as_ref() } {
            if lost.depth < DEEPEST_CALL_CHAIN {
                lost.components[lost.depth] = inside.component;
                lost.depth += 1;
            }
            next = inside.outer;
        }
        // SAFETY: this thread is the lane's only one; see the `Sync` argument.
        unsafe { *self.record.get() = Some(lost) };
        self.state.store(PUBLISHED, Ordering::Release);
        wake_spare();
    }
}

/// Number of losses so far; to be passed to [`wait_for_loss`].
pub fn losses() -> u32 {
    LOSSES.load(Ordering::Acquire)
}

/// Sleeps until the number of losses differs from `seen`, or `limit` has passed.
pub fn wait_for_loss(seen: u32, limit: Duration) {
    let limit = futex::Timespec {
        tv_sec: i64::try_from(limit.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: i64::from(limit.subsec_nanos()),
    };
    // A wrong guess, a signal or the time limit: the caller looks again in every case.
    let _ = futex::wait(&LOSSES, futex::Flags::PRIVATE, seen, Some(&limit));
}

/// Wakes the thread that waits for losses. Two instructions and one system call: fit for handlers.
pub fn wake_spare() {
    LOSSES.fetch_add(1, Ordering::AcqRel);
    let _ = futex::wake(&LOSSES, futex::Flags::PRIVATE, u32::MAX);
}
