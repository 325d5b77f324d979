//! The stack that a component runs on: its own mapping with a wide guard area below.

use std::io;
use std::num::NonZeroUsize;
use std::ptr;

use corosensei::stack::{Stack, StackPointer};

use super::copy::guarded_copy;

/// Usable stack. Address space only: pages become memory when they are touched. As much as a main
/// thread's first megabyte, so that code with large frames works without being told.
const STACK_BYTES: usize = 1 << 20;

/// Guard area below it. One page would do for Rust, which probes every page; C frames are not
/// probed, so the guard must be wider than any sane frame.
const GUARD_BYTES: usize = 1 << 18;

/// So much of a stack is made memory ahead where its owner may be in a hurry: callbacks that need
/// more wait for it.
const TOUCHED_BYTES: usize = 64 * 1024;

/// A mapped stack.
pub(super) struct ComponentStack {
    base: StackPointer,
    limit: StackPointer,
}

impl ComponentStack {
    /// Maps a stack.
    pub(super) fn new() -> io::Result<Self> {
        let length = STACK_BYTES + GUARD_BYTES;
        let flags = libc::MAP_ANONYMOUS | libc::MAP_PRIVATE | libc::MAP_NORESERVE;
        // SAFETY: a new anonymous mapping at an address that the kernel chooses.
        let start = unsafe { libc::mmap(ptr::null_mut(), length, libc::PROT_NONE, flags, -1, 0) };
        if start == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
        let limit = NonZeroUsize::new(start as usize)
            .ok_or_else(|| io::Error::other("the kernel mapped a stack at address zero"))?;
        let base = limit
            .checked_add(length)
            .ok_or_else(|| io::Error::other("the kernel mapped a stack at the end of memory"))?;
        let stack = Self { base, limit };
        let usable = (limit.get() + GUARD_BYTES) as *mut libc::c_void;
        // SAFETY: the range is the upper part of the mapping made above.
        let result =
            unsafe { libc::mprotect(usable, STACK_BYTES, libc::PROT_READ | libc::PROT_WRITE) };
        if result != 0 {
            return Err(io::Error::last_os_error());
        }
        Ok(stack)
    }

    /// Whether `address` lies in the guard area: a stack pointer or a fault there is an overflow.
    pub(super) fn guard_contains(limit: usize, address: usize) -> bool {
        (limit..limit + GUARD_BYTES).contains(&address)
    }
}

/// The memory of a stack, whatever became of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct StackMemory {
    /// Lowest address.
    pub(super) limit: usize,
    /// One past the highest.
    pub(super) base: usize,
}

impl StackMemory {
    /// Makes the upper part of it memory now, so that who runs there first need not wait for pages.
    /// A system that cannot do that lets him wait.
    pub(super) fn touch(self) {
        let start = self.base.saturating_sub(TOUCHED_BYTES).max(self.limit);
        let (start, length) = (start as *mut libc::c_void, self.base - start);
        let advice = rustix::mm::Advice::LinuxPopulateWrite;
        // SAFETY: the range is ours, and what is in it stays as it is.
        let _he_waits = unsafe { rustix::mm::madvise(start, length, advice) };
    }

    /// The word at an address; `None` outside the stack and in its guard area.
    pub(super) fn read(self, address: usize) -> Option<usize> {
        const WORD_BYTES: usize = size_of::<usize>();
        let end = address.checked_add(WORD_BYTES)?;
        if address < self.limit || end > self.base {
            return None;
        }
        let mut word = 0usize;
        // SAFETY: `word` is ours; the other side is what nobody reads but the component, and may be
        // inaccessible, which the copy survives.
        let readable =
            unsafe { guarded_copy((&raw mut word).cast(), address as *const u8, WORD_BYTES) };
        readable.then_some(word)
    }
}

impl Drop for ComponentStack {
    fn drop(&mut self) {
        let length = self.base.get() - self.limit.get();
        // SAFETY: the mapping was made in `new`; nothing runs on it, the coroutine is finished.
        unsafe { libc::munmap(self.limit.get() as *mut libc::c_void, length) };
    }
}

// SAFETY: base and limit are page-aligned ends of one mapping whose lowest part is inaccessible.
unsafe impl Stack for ComponentStack {
    fn base(&self) -> StackPointer {
        self.base
    }
    fn limit(&self) -> StackPointer {
        self.limit
    }
}
