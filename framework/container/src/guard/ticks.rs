//! The processor's own counter: what it costs to note a moment with it is little beside a callback,
//! where a look at the clock would be several times as much.
#![allow(unsafe_code)] // an instruction that the language has no word for

/// Counts up steadily while the machine runs; how fast is for the reader to find out. Always 0 where
/// the processor has no such counter for us: then no two moments differ.
#[inline]
pub(crate) fn ticks() -> u64 {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every processor of this architecture has the instruction; it touches no memory.
    unsafe {
        core::arch::x86_64::_rdtsc()
    }
    #[cfg(not(target_arch = "x86_64"))]
    0
}
