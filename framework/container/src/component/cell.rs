//! Who may enter a component: one thread at a time. Only components whose services are called from
//! other threads pay for the question.
#![allow(unsafe_code)] // exclusive access by a flag that the compiler cannot see

use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::{Duration, Instant};

use rustix::thread::futex;

use super::Component;
use crate::guard::loss::LostThread;

/// A component that several threads may want to enter.
pub struct ComponentCell {
    /// 0: free; else the token of the thread inside, with [`WAITING`] if another one waits.
    entered: AtomicU32,
    /// Whether threads other than that of its executor may want to enter.
    shared: AtomicBool,
    component: UnsafeCell<Component>,
}

/// Somebody waits for the component to be free.
const WAITING: u32 = 1 << 31;

// SAFETY: the component is reached only through `Entered`, of which there is one at a time: by the
// flag if it is shared; else only the lane that runs it enters, and the lane that starts and stops
// the application does so while no other runs. After a loss the thread that takes over stands in
// for the one that stopped for ever.
unsafe impl Sync for ComponentCell {}

/// Being inside a component; leaves it when dropped.
pub struct Entered<'cell> {
    cell: &'cell ComponentCell,
}

impl ComponentCell {
    /// A component that nobody is inside of.
    pub fn new(component: Component) -> Self {
        Self {
            entered: AtomicU32::new(0),
            shared: AtomicBool::new(false),
            component: UnsafeCell::new(component),
        }
    }

    /// From now on other threads may want to enter: its services are called. To be said before
    /// anything runs.
    pub fn share(&self) {
        self.shared.store(true, Ordering::Release);
    }

    /// Enters the component on behalf of the thread with this token (not 0), waiting at most
    /// `limit`. `None` if it does not become free, or if this very thread is inside already.
    #[inline]
    pub fn enter(&self, token: u32, limit: Duration) -> Option<Entered<'_>> {
        if !self.shared.load(Ordering::Relaxed) {
            return Some(Entered { cell: self });
        }
        let free = self
            .entered
            .compare_exchange(0, token, Ordering::Acquire, Ordering::Relaxed);
        // Only made when inside: dropping an `Entered` leaves the component.
        if free.is_ok() {
            Some(Entered { cell: self })
        } else {
            self.enter_slowly(token, limit)
        }
    }

    #[cold]
    fn enter_slowly(&self, token: u32, limit: Duration) -> Option<Entered<'_>> {
        let start = Instant::now();
        loop {
            let inside = self.entered.load(Ordering::Relaxed);
            if inside == 0 {
                let free =
                    self.entered
                        .compare_exchange(0, token, Ordering::Acquire, Ordering::Relaxed);
                if free.is_ok() {
                    return Some(Entered { cell: self });
                }
                continue;
            }
            let left = limit.checked_sub(start.elapsed())?;
            if inside & !WAITING == token {
                return None;
            }
            let marked = inside | WAITING;
            let waits = inside == marked
                || self
                    .entered
                    .compare_exchange(inside, marked, Ordering::Relaxed, Ordering::Relaxed)
                    .is_ok();
            if waits {
                let left = futex::Timespec {
                    tv_sec: i64::try_from(left.as_secs()).unwrap_or(i64::MAX),
                    tv_nsec: i64::from(left.subsec_nanos()),
                };
                // Woken, interrupted or too late: the loop looks again.
                let _look_again =
                    futex::wait(&self.entered, futex::Flags::PRIVATE, marked, Some(&left));
            }
        }
    }
}

/// Puts the components that a lost thread is inside of for ever into ERROR: those of its executor
/// and those whose services they had called. `components` are all of the application; only the
/// thread that took the lane over may call this, with the record of that lane's loss. `reported`:
/// the fault manager learns of it as the failure of what it had ordered.
pub(crate) fn mark_lost(components: &[Arc<ComponentCell>], lost: &LostThread, reported: bool) {
    for number in &lost.components[..lost.depth] {
        if let Some(cell) = components.get(*number as usize) {
            // The thread inside never runs again, so being inside passes to this one.
            let mut component = Entered { cell };
            let fault = component.lost(lost);
            if !reported {
                component.report(&fault);
            }
        }
    }
}

impl Deref for Entered<'_> {
    type Target = Component;
    fn deref(&self) -> &Component {
        // SAFETY: being inside is exclusive.
        unsafe { &*self.cell.component.get() }
    }
}

impl DerefMut for Entered<'_> {
    fn deref_mut(&mut self) -> &mut Component {
        // SAFETY: being inside is exclusive.
        unsafe { &mut *self.cell.component.get() }
    }
}

impl Drop for Entered<'_> {
    #[inline]
    fn drop(&mut self) {
        if self.cell.shared.load(Ordering::Relaxed)
            && self.cell.entered.swap(0, Ordering::Release) & WAITING != 0
        {
            let _woken = futex::wake(&self.cell.entered, futex::Flags::PRIVATE, u32::MAX);
        }
    }
}
