//! The memory that the container and one instance in a host share: sealed, without a name, gone
//! with its last user. One of the two has the turn; the other one sleeps on that word.
#![allow(unsafe_code)] // memory that another process writes to

use std::io;
use std::os::fd::{AsFd as _, BorrowedFd, OwnedFd};
use std::ptr;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

use rustix::fs::{MemfdFlags, SealFlags};
use rustix::mm::{Advice, MapFlags, MprotectFlags, ProtFlags};
use rustix::thread::futex;
use rustix::time::ClockId;

use super::deadline;
use super::layout::{Area, Layout};
use super::message::Words;
use crate::guard::{ForeignBytesMut, ForeignText};

/// Whose turn it is.
const TURN: usize = 0;
/// The host's sign of life: the number of its main thread, and [`WAITERS`], until it dies.
const LIFE: usize = 64;
/// Links the sign of life into the list that the kernel walks when the host dies.
const LIFE_LINK: usize = 128;
/// Number of the call that is to be broken off; 0: none.
const CONDEMNED: usize = 176;
/// How long the text is that the host left behind at last, and one; 0 while there is none.
const TEXT: usize = 184;
/// The words of a message.
const WORDS: usize = 192;

/// Words of a message.
pub(super) const WORD_COUNT: usize = 24;

/// Turns.
const HOST: u32 = 1;
const CONTAINER: u32 = 2;

/// Set in the sign of life by the kernel when its owner dies, or by the one that reaps.
const OWNER_DIED: u32 = 0x4000_0000;
/// Makes the kernel wake a waiter then.
const WAITERS: u32 = 0x8000_0000;

/// From the link to the sign of life, as the kernel wants to know it.
pub(super) const LIFE_OFFSET: isize = LIFE.cast_signed() - LIFE_LINK.cast_signed();

/// The shared memory, mapped.
#[derive(Debug)]
pub(super) struct Channel {
    base: *mut u8,
    size: usize,
    memory: OwnedFd,
}

// SAFETY: the mapping lives as long as the value; words are atomic, other bytes are copied by
// routines that take them for foreign memory, and only by the side that has the turn.
unsafe impl Send for Channel {}
// SAFETY: as above.
unsafe impl Sync for Channel {}

/// How waiting for the other side ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Waited {
    /// It is the waiter's turn.
    Turn,
    /// The host is dead.
    Dead,
    /// Neither, within the time.
    Late,
}

impl Channel {
    /// New shared memory of this size, mapped, of which the first `front` bytes are used all the
    /// time; it is the host's turn.
    ///
    /// # Errors
    /// If the machine has no room.
    pub(super) fn create(size: usize, front: usize) -> io::Result<Self> {
        let flags = MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING;
        let memory = rustix::fs::memfd_create(c"component", flags)?;
        rustix::fs::ftruncate(&memory, size as u64)?;
        // A host that shortens it would take the container's memory away under its feet.
        let seals = SealFlags::SHRINK | SealFlags::GROW | SealFlags::SEAL;
        rustix::fs::fcntl_add_seals(&memory, seals)?;
        let channel = Self::open(memory, size, front)?;
        channel.turn().store(HOST, Ordering::Release);
        Ok(channel)
    }

    /// Maps memory that the other side has made; `front` as for [`Self::create`].
    ///
    /// # Errors
    /// If the machine has no room.
    pub(super) fn open(memory: OwnedFd, size: usize, front: usize) -> io::Result<Self> {
        // Where all memory of a process is locked, a mapping that can be used gets all its pages at
        // once, and nearly all of these are room for critical memory that few components have.
        // SAFETY: a new mapping at a place that the kernel chooses.
        let base = unsafe {
            rustix::mm::mmap(
                ptr::null_mut(),
                size,
                ProtFlags::empty(),
                MapFlags::SHARED,
                &memory,
                0,
            )
        }?;
        // SAFETY: the mapping is of this size, and nobody knows it yet.
        unsafe { rustix::mm::mprotect(base, size, MprotectFlags::READ | MprotectFlags::WRITE) }?;
        // Older kernels do not know this: then the pages come when they are first used.
        // SAFETY: as above; the advice changes no content.
        let _later = unsafe { rustix::mm::madvise(base, front, Advice::LinuxPopulateWrite) };
        Ok(Self {
            base: base.cast(),
            size,
            memory,
        })
    }

    /// The memory itself.
    pub(super) fn memory(&self) -> BorrowedFd<'_> {
        self.memory.as_fd()
    }

    /// Leaves a message, for when the turn is given away.
    pub(super) fn say(&self, words: &Words) {
        for (index, word) in words.iter().enumerate() {
            self.word(WORDS + 8 * index).store(*word, Ordering::Relaxed);
        }
    }

    /// The message that was left.
    pub(super) fn hear(&self) -> Words {
        std::array::from_fn(|index| self.word(WORDS + 8 * index).load(Ordering::Relaxed))
    }

    /// What a component is offered to read at a port of the layout; `None` if there is no such port.
    pub(super) fn offer(&self, layout: &Layout, port: u32) -> Option<&AtomicU64> {
        let place = layout.offers.part(8 * port as usize, 8)?;
        (place.offset + place.size <= self.size).then(|| self.word(place.offset))
    }

    /// Bytes of a part of the memory; none of a part that is not inside.
    pub(super) fn bytes(&self, area: Area) -> ForeignBytesMut {
        let end = area.offset.checked_add(area.size);
        if end.is_none_or(|end| end > self.size) {
            return ForeignBytesMut::at(0, 0);
        }
        ForeignBytesMut::at(self.base.expose_provenance() + area.offset, area.size)
    }

    /// In the container: the call of this number is to be broken off.
    pub(super) fn condemn(&self, number: u32) {
        self.condemned().store(number, Ordering::Release);
        let _ = futex::wake(self.condemned(), futex::Flags::empty(), 1);
    }

    /// In the host: sleeps until another call than that of this number is to be broken off; its
    /// number.
    pub(super) fn wait_for_condemnation(&self, last: u32) -> u32 {
        loop {
            let condemned = self.condemned().load(Ordering::Acquire);
            if condemned != last {
                return condemned;
            }
            // Woken, the word has changed, or a signal: look again in every case.
            let _ = futex::wait(self.condemned(), futex::Flags::empty(), last, None);
        }
    }

    /// In the host: there is a text of this size for the container, after the instance's end.
    pub(super) fn leave_text(&self, size: usize) {
        self.word(TEXT).store(size as u64 + 1, Ordering::Release);
    }

    /// In the container: its size, if it is there.
    pub(super) fn text_size(&self) -> Option<usize> {
        let left = self.word(TEXT).load(Ordering::Acquire).checked_sub(1)?;
        usize::try_from(left).ok()
    }

    /// A text of the host, of this size; as much of it as can be there.
    pub(super) fn text(&self, area: Area, size: usize) -> String {
        let Some(part) = area.part(0, size.min(area.size)) else {
            return String::new();
        };
        let text = ForeignText::of(self.bytes(part).for_reading()).read();
        text.unwrap_or_default()
    }

    /// Gives the host the turn and wakes it.
    pub(super) fn hand_to_host(&self) {
        self.hand_to(HOST);
    }

    /// Gives the container the turn and wakes it.
    pub(super) fn hand_to_container(&self) {
        self.hand_to(CONTAINER);
    }

    /// In the host: sleeps until it is the host's turn.
    pub(super) fn wait_for_container(&self) {
        while self.turn().load(Ordering::Acquire) != HOST {
            // Woken, the turn has changed, or a signal: look again in every case.
            let _ = futex::wait(self.turn(), futex::Flags::empty(), CONTAINER, None);
        }
    }

    /// In the container: sleeps until it is the container's turn, the host is dead, or `limit` has
    /// passed.
    pub(super) fn wait_for_host(&self, limit: Duration) -> Waited {
        let deadline = deadline::after(limit);
        loop {
            if self.turn().load(Ordering::Acquire) == CONTAINER {
                return Waited::Turn;
            }
            let life = self.life().load(Ordering::Acquire);
            if is_dead(life) {
                return Waited::Dead;
            }
            let words = [waiter(self.turn(), HOST), waiter(self.life(), life)];
            let flags = futex::WaitvFlags::empty();
            match futex::waitv(&words, flags, Some(&deadline), ClockId::Monotonic) {
                Err(rustix::io::Errno::TIMEDOUT) => return Waited::Late,
                // Woken, a word has changed, or a signal: look again.
                Ok(_) | Err(rustix::io::Errno::AGAIN | rustix::io::Errno::INTR) => {}
                // A kernel before 5.16: the death is found by whoever reaps.
                Err(_not_there) => {
                    if !self.nap(&deadline) {
                        return Waited::Late;
                    }
                }
            }
        }
    }

    /// Whether the host is dead.
    pub(super) fn is_dead(&self) -> bool {
        is_dead(self.life().load(Ordering::Acquire))
    }

    /// In the host: says that its main thread, which is the caller, lives. What must be linked into
    /// the list that the kernel walks when the thread dies.
    pub(super) fn show_life(&self) -> *mut u64 {
        let thread = rustix::thread::gettid().as_raw_nonzero().get();
        self.life()
            .store(thread.cast_unsigned() | WAITERS, Ordering::Release);
        self.base.wrapping_add(LIFE_LINK).cast()
    }

    /// In the container: whether nobody waits for the host.
    pub(super) fn is_idle(&self) -> bool {
        self.turn().load(Ordering::Acquire) == CONTAINER
    }

    /// In the container: the host was reaped.
    pub(super) fn mark_dead(&self) {
        self.life().fetch_or(OWNER_DIED, Ordering::AcqRel);
        let _ = futex::wake(self.life(), futex::Flags::empty(), u32::MAX);
    }

    fn hand_to(&self, whom: u32) {
        self.turn().store(whom, Ordering::Release);
        let _ = futex::wake(self.turn(), futex::Flags::empty(), 1);
    }

    /// Waits for the turn alone, a moment; false once `deadline` has passed.
    fn nap(&self, deadline: &futex::Timespec) -> bool {
        const MOMENT: futex::Timespec = futex::Timespec {
            tv_sec: 0,
            tv_nsec: 1_000_000,
        };
        let _ = futex::wait(self.turn(), futex::Flags::empty(), HOST, Some(&MOMENT));
        !deadline::has_passed(deadline)
    }

    /// A word at a multiple of eight bytes.
    fn word(&self, offset: usize) -> &AtomicU64 {
        assert!(
            offset.is_multiple_of(8) && offset + 8 <= self.size,
            "no such word"
        );
        // SAFETY: inside the mapping, aligned, and only used atomically.
        unsafe { AtomicU64::from_ptr(self.base.wrapping_add(offset).cast()) }
    }

    fn turn(&self) -> &AtomicU32 {
        // SAFETY: inside the header, aligned, and only used atomically.
        unsafe { AtomicU32::from_ptr(self.base.wrapping_add(TURN).cast()) }
    }

    fn condemned(&self) -> &AtomicU32 {
        // SAFETY: as above.
        unsafe { AtomicU32::from_ptr(self.base.wrapping_add(CONDEMNED).cast()) }
    }

    fn life(&self) -> &AtomicU32 {
        // SAFETY: as above.
        unsafe { AtomicU32::from_ptr(self.base.wrapping_add(LIFE).cast()) }
    }
}

impl Drop for Channel {
    fn drop(&mut self) {
        // SAFETY: mapped by `open`, and nobody can name it any more. If it fails it stays.
        let _ = unsafe { rustix::mm::munmap(self.base.cast(), self.size) };
    }
}

fn is_dead(life: u32) -> bool {
    life & OWNER_DIED != 0
}

fn waiter(word: &AtomicU32, value: u32) -> futex::Wait {
    let mut waiter = futex::Wait::new();
    waiter.val = u64::from(value);
    waiter.uaddr = futex::WaitPtr::new(word.as_ptr().cast());
    waiter.flags = futex::WaitFlags::SIZE_U32;
    waiter
}
