//! An allocator that remembers when one thread used it.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

/// The thread that is looked at; 0: none.
static THREAD: AtomicI32 = AtomicI32::new(0);

/// Uses that are remembered: more than any run has on that thread.
const MOST: usize = 1 << 20;

static TIMES_NS: [AtomicU64; MOST] = [const { AtomicU64::new(0) }; MOST];
static COUNT: AtomicUsize = AtomicUsize::new(0);
static BEGIN: OnceLock<Instant> = OnceLock::new();

thread_local! {
    // Const-initialised, so that reading it does not allocate.
    static OWN: Cell<i32> = const { Cell::new(0) };
}

/// From now on uses by this thread are remembered.
pub fn look_at(thread: i32) {
    BEGIN.get_or_init(Instant::now);
    THREAD.store(thread, Ordering::Release);
}

/// How often it was used from one instant to another.
pub fn between(from: Instant, to: Instant) -> usize {
    let Some(begin) = BEGIN.get() else { return 0 };
    let ns = |instant: Instant| (instant - *begin).as_nanos() as u64;
    let count = COUNT.load(Ordering::Acquire).min(MOST);
    let times = TIMES_NS[..count]
        .iter()
        .map(|time| time.load(Ordering::Relaxed));
    times
        .filter(|time| (ns(from)..=ns(to)).contains(time))
        .count()
}

/// The system's allocator, watched.
pub struct Recording;

impl Recording {
    fn record() {
        let thread = THREAD.load(Ordering::Relaxed);
        if thread == 0 {
            return;
        }
        if OWN.get() == 0 {
            OWN.set(rustix::thread::gettid().as_raw_nonzero().get());
        }
        if OWN.get() == thread
            && let Some(begin) = BEGIN.get()
        {
            let index = COUNT.fetch_add(1, Ordering::AcqRel);
            if let Some(place) = TIMES_NS.get(index) {
                place.store(begin.elapsed().as_nanos() as u64, Ordering::Relaxed);
            }
        }
    }
}

// SAFETY: everything is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Recording {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        Self::record();
        // SAFETY: by this function's contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        Self::record();
        // SAFETY: by this function's contract.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        Self::record();
        // SAFETY: by this function's contract.
        unsafe { System.realloc(pointer, layout, size) }
    }
}
