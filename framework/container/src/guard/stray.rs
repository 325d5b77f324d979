//! Faults in threads that components made themselves. Such a thread runs on no stack of ours, so
//! the component is found by its code: the interrupted instruction, or a return address on the
//! thread's stack when the fault hit in the C library. The thread stops for ever and the component
//! is told on when its executor looks at it next.

use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicPtr, AtomicUsize, Ordering};

use super::code::CodeRange;
use super::copy::guarded_copy;
use super::registers::Registers;
use super::trap::Trap;

/// Copies of libraries that can be told apart: those of a thousand components, each with standbys
/// and recoveries. Further ones are protected in their callbacks only.
const MOST_CLAIMS: usize = 8192;

/// How much of a stack is searched for a return address: the C library's own frames between a
/// component and a fault (`abort`, `memcpy`, `printf`) take less.
const SEARCHED_BYTES: usize = 4096;

static CLAIMS: [Claim; MOST_CLAIMS] = [const { Claim::empty() }; MOST_CLAIMS];
static CLAIMED: AtomicUsize = AtomicUsize::new(0);

/// One library copy's code, and where word is left for its component.
struct Claim {
    start: AtomicUsize,
    end: AtomicUsize,
    word: AtomicPtr<Word>,
}

/// Where the handler leaves word of a fault. Lives as long as the process.
#[derive(Debug, Default)]
pub(super) struct Word {
    left: AtomicBool,
    signal: AtomicI32,
    address: AtomicUsize,
    instruction_pointer: AtomicUsize,
}

impl Claim {
    const fn empty() -> Self {
        Self {
            start: AtomicUsize::new(0),
            end: AtomicUsize::new(0),
            word: AtomicPtr::new(ptr::null_mut()),
        }
    }
}

impl Word {
    /// The fault that a thread of the component met, once.
    #[inline]
    pub(super) fn take(&self) -> Option<Trap> {
        if !self.left.load(Ordering::Acquire) {
            return None;
        }
        self.left.store(false, Ordering::Release);
        Some(Trap {
            signal: self.signal.load(Ordering::Relaxed),
            code: 0,
            address: self.address.load(Ordering::Relaxed),
            registers: Registers {
                instruction_pointer: self.instruction_pointer.load(Ordering::Relaxed),
                ..Registers::default()
            },
            stack_overflow: false,
            hang: None,
        })
    }

    /// Leaves word and stops the calling thread for ever. Called inside the handler.
    pub(super) fn leave_and_park(&self, signal: i32, address: usize, at: usize) -> ! {
        self.signal.store(signal, Ordering::Relaxed);
        self.address.store(address, Ordering::Relaxed);
        self.instruction_pointer.store(at, Ordering::Relaxed);
        self.left.store(true, Ordering::Release);
        loop {
            // SAFETY: no precondition; returns after a signal was handled.
            unsafe { libc::pause() };
        }
    }
}

/// Claims a library copy's code for a component. A copy that several instances share is the first
/// one's.
pub(super) fn claim(code: CodeRange) -> &'static Word {
    let word: &'static Word = Box::leak(Box::default());
    if word_for(code.start).is_some() || code.start >= code.end {
        return word;
    }
    let index = CLAIMED.fetch_add(1, Ordering::AcqRel);
    if let Some(claim) = CLAIMS.get(index) {
        claim.end.store(code.end, Ordering::Relaxed);
        claim.start.store(code.start, Ordering::Relaxed);
        // The handler looks at the word first: what it finds there is complete.
        claim
            .word
            .store(ptr::from_ref(word).cast_mut(), Ordering::Release);
    }
    word
}

/// The word of the component whose code the calling thread is in, or was called from. Called
/// inside the handler.
pub(super) fn culprit(instruction_pointer: usize, stack_pointer: usize) -> Option<&'static Word> {
    const ADDRESS_BYTES: usize = size_of::<usize>();
    if let Some(word) = word_for(instruction_pointer) {
        return Some(word);
    }
    let aligned = stack_pointer & !(ADDRESS_BYTES - 1);
    for offset in (0..SEARCHED_BYTES).step_by(ADDRESS_BYTES) {
        let mut address = 0usize;
        let from = aligned.wrapping_add(offset) as *const u8;
        // SAFETY: `address` is ours; the stack may end here, which the copy survives.
        let readable = unsafe { guarded_copy((&raw mut address).cast(), from, ADDRESS_BYTES) };
        if !readable {
            return None;
        }
        if let Some(word) = word_for(address) {
            return Some(word);
        }
    }
    None
}

fn word_for(address: usize) -> Option<&'static Word> {
    let count = CLAIMED.load(Ordering::Acquire).min(MOST_CLAIMS);
    CLAIMS[..count].iter().find_map(|claim| {
        // SAFETY: null, or a leaked word.
        let word = unsafe { claim.word.load(Ordering::Acquire).as_ref() }?;
        let range = claim.start.load(Ordering::Relaxed)..claim.end.load(Ordering::Relaxed);
        range.contains(&address).then_some(word)
    })
}
