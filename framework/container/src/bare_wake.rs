//! The least that it takes to wake another process and be woken by it: one word of shared memory
//! each way, and the kernel's futex. What tiers of isolation cost is measured against it.
#![allow(unsafe_code)] // shared memory

use std::fs::{File, OpenOptions};
use std::io;
use std::os::fd::AsRawFd as _;
use std::path::{Path, PathBuf};
use std::ptr;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use rustix::fs::MemfdFlags;
use rustix::io::Errno;
use rustix::mm::{MapFlags, ProtFlags, mmap};
use rustix::thread::futex::{Flags, wait, wake};

/// A partner that does not answer for so long has died.
const PATIENCE: Duration = Duration::from_secs(5);

/// Two words that two processes share.
#[derive(Debug)]
pub struct BareWake {
    /// Written by the one that asks, and by the one that answers. Each in a cache line of its own.
    words: &'static Words,
    file: File,
}

#[repr(C)]
#[derive(Debug)]
struct Words {
    asked: Line,
    answered: Line,
}

#[repr(C, align(64))]
#[derive(Debug)]
struct Line(AtomicU32);

impl BareWake {
    /// New words, both zero.
    ///
    /// # Errors
    /// If the system refuses the memory.
    pub fn create() -> io::Result<Self> {
        let file = File::from(rustix::fs::memfd_create(c"wake", MemfdFlags::CLOEXEC)?);
        file.set_len(size_of::<Words>() as u64)?;
        Self::map(file)
    }

    /// The words of another process, by [`Self::path`] of that.
    ///
    /// # Errors
    /// If there are none.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        if file.metadata()?.len() < size_of::<Words>() as u64 {
            return Err(io::Error::other("this is no shared memory of a wake"));
        }
        Self::map(file)
    }

    /// By which another process of the same user opens them, while this value lives.
    pub fn path(&self) -> PathBuf {
        let (process, file) = (std::process::id(), self.file.as_raw_fd());
        PathBuf::from(format!("/proc/{process}/fd/{file}"))
    }

    /// Wakes the other process and waits until it has answered. Not by two threads at once.
    ///
    /// # Errors
    /// If it does not answer in 5 s.
    pub fn round_trip(&self) -> io::Result<()> {
        let Words { asked, answered } = self.words;
        let number = asked.0.load(Ordering::Relaxed).wrapping_add(1);
        asked.0.store(number, Ordering::Release);
        wake(&asked.0, Flags::empty(), 1)?;
        let before = number.wrapping_sub(1);
        wait_while(&answered.0, before)
    }

    /// Answers whoever asks, until nobody has asked for 5 s.
    ///
    /// # Errors
    /// Says so then.
    pub fn answer(&self) -> io::Result<()> {
        let Words { asked, answered } = self.words;
        loop {
            let last = answered.0.load(Ordering::Relaxed);
            wait_while(&asked.0, last)?;
            answered.0.store(last.wrapping_add(1), Ordering::Release);
            wake(&answered.0, Flags::empty(), 1)?;
        }
    }

    fn map(file: File) -> io::Result<Self> {
        let protection = ProtFlags::READ | ProtFlags::WRITE;
        let length = size_of::<Words>();
        // SAFETY: a new mapping at an address that the kernel chooses.
        let memory = unsafe {
            mmap(
                ptr::null_mut(),
                length,
                protection,
                MapFlags::SHARED,
                &file,
                0,
            )
        }?;
        // SAFETY: page-aligned, as long as `Words`, never unmapped, and never shorter: nobody
        // shortens a file that only the two processes know. Any bits are words.
        let words = unsafe { &*memory.cast::<Words>() };
        Ok(Self { words, file })
    }
}

/// Sleeps until the word has another value.
fn wait_while(word: &AtomicU32, value: u32) -> io::Result<()> {
    let limit = rustix::fs::Timespec {
        tv_sec: i64::try_from(PATIENCE.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: 0,
    };
    while word.load(Ordering::Acquire) == value {
        match wait(word, Flags::empty(), value, Some(&limit)) {
            Ok(()) | Err(Errno::AGAIN | Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_question_is_answered_once() {
        let asking = BareWake::create().expect("shared memory");
        let answering = BareWake::open(&asking.path()).expect("the same memory");
        std::thread::spawn(move || answering.answer());
        for _ in 0..100 {
            asking.round_trip().expect("an answer");
        }
        assert_eq!(asking.words.asked.0.load(Ordering::Relaxed), 100);
        assert_eq!(asking.words.answered.0.load(Ordering::Relaxed), 100);
    }

    #[test]
    fn what_is_too_short_is_not_mapped() {
        let empty = tempfile::NamedTempFile::new().expect("a file");
        assert!(BareWake::open(empty.path()).is_err());
    }
}
