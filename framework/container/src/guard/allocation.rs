//! `malloc` and its kin, defined in the executable so that components bind to them first: what a
//! callback allocates on its component's stack, less what it frees, is summed up for the rule about
//! memory. The work is the C library's; outside a component that is counted, the price is one look
//! at a thread-local.
//!
//! A fault in here or below is outside the component's own code: its thread is set aside, because
//! the allocator's lock may be held. So no figure is ever half written.
//!
//! An executable that loads components must export these symbols; see `exported_symbols.rs`.

use std::cell::Cell;

use libc::{c_int, c_void, size_t};

use super::host::HostSide;
use super::trap;

// The C library's own, by the names that it keeps for whoever interposes the others: no look-up,
// which would allocate.
unsafe extern "C" {
    fn __libc_malloc(size: size_t) -> *mut c_void;
    fn __libc_calloc(count: size_t, size: size_t) -> *mut c_void;
    fn __libc_realloc(memory: *mut c_void, size: size_t) -> *mut c_void;
    fn __libc_free(memory: *mut c_void);
    fn __libc_memalign(alignment: size_t, size: size_t) -> *mut c_void;
}

thread_local! {
    // Const-initialised and without a destructor, so that the trap handler may read it.
    static INSIDE: Cell<bool> = const { Cell::new(false) };
}

/// Whether a component of this thread is inside the allocator: a fault there means that the heap is
/// damaged, and that its lock may be held.
pub(super) fn is_inside() -> bool {
    INSIDE.get()
}

/// Lets the C library work, with a mark of that while a component waits for it.
#[inline]
fn inside<Answer>(work: impl FnOnce() -> Answer) -> Answer {
    if trap::current().is_null() {
        return work();
    }
    INSIDE.set(true);
    let answer = work();
    INSIDE.set(false);
    answer
}

/// The host side of the component that is to be charged: the one on whose stack the caller runs,
/// not while a request is answered there.
#[inline]
fn charged() -> Option<&'static HostSide> {
    // SAFETY: null, or the frame of a call that is under way on this thread.
    let frame = unsafe { trap::current().as_ref() }?;
    // SAFETY: the host side outlives the call, and so all that happens on this stack.
    let side = unsafe { &*frame.context };
    side.counts_allocations().then_some(side)
}

/// What the allocator has set aside for a piece of memory, in bytes; 0 for null.
#[inline]
fn usable(memory: *mut c_void) -> usize {
    // SAFETY: null, or memory of this allocator (contract of every caller).
    unsafe { libc::malloc_usable_size(memory) }
}

#[inline]
fn charge(memory: *mut c_void) -> *mut c_void {
    if let Some(side) = charged() {
        side.charge(0, usable(memory));
    }
    memory
}

/// As `malloc(3)`.
#[unsafe(no_mangle)]
pub extern "C" fn malloc(size: size_t) -> *mut c_void {
    // SAFETY: any size may be asked for.
    charge(inside(|| unsafe { __libc_malloc(size) }))
}

/// As `calloc(3)`.
#[unsafe(no_mangle)]
pub extern "C" fn calloc(count: size_t, size: size_t) -> *mut c_void {
    // SAFETY: any size may be asked for.
    charge(inside(|| unsafe { __libc_calloc(count, size) }))
}

/// As `memalign(3)`.
#[unsafe(no_mangle)]
pub extern "C" fn memalign(alignment: size_t, size: size_t) -> *mut c_void {
    // SAFETY: the C library makes do with any alignment.
    charge(inside(|| unsafe { __libc_memalign(alignment, size) }))
}

/// As `aligned_alloc(3)` of the C library, where it is another name for `memalign`.
#[unsafe(no_mangle)]
pub extern "C" fn aligned_alloc(alignment: size_t, size: size_t) -> *mut c_void {
    memalign(alignment, size)
}

/// As `posix_memalign(3)`.
///
/// # Safety
/// `memory` points to a place for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn posix_memalign(
    memory: *mut *mut c_void,
    alignment: size_t,
    size: size_t,
) -> c_int {
    if !alignment.is_power_of_two() || alignment < size_of::<*mut c_void>() {
        return libc::EINVAL;
    }
    let found = memalign(alignment, size);
    if found.is_null() {
        return libc::ENOMEM;
    }
    // SAFETY: by this function's contract.
    unsafe { memory.write(found) };
    0
}

/// As `realloc(3)`.
///
/// # Safety
/// `memory` is null, or of this allocator and not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realloc(memory: *mut c_void, size: size_t) -> *mut c_void {
    let Some(side) = charged() else {
        // SAFETY: by this function's contract.
        return inside(|| unsafe { __libc_realloc(memory, size) });
    };
    let before = usable(memory);
    // SAFETY: by this function's contract.
    let moved = inside(|| unsafe { __libc_realloc(memory, size) });
    // Null for a size means that nothing has changed; null for no size, that it was freed.
    if !moved.is_null() || size == 0 {
        side.charge(before, usable(moved));
    }
    moved
}

/// As `free(3)`.
///
/// # Safety
/// `memory` is null, or of this allocator and not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn free(memory: *mut c_void) {
    if let Some(side) = charged() {
        side.charge(usable(memory), 0);
    }
    // SAFETY: by this function's contract.
    inside(|| unsafe { __libc_free(memory) });
}

#[cfg(test)]
mod tests;
