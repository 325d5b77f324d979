//! The least that it takes to learn of the death of another process: one word on the list that the
//! kernel walks when a thread dies, and a sleep on that word. What the tier `process` takes to learn
//! of a host's end is measured against it.

use std::fs::OpenOptions;
use std::io;
use std::os::fd::AsRawFd as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::channel::{Channel, Waited};
use super::robust::SignsOfLife;

/// Of the shared memory: a page, of which the words at its beginning are used.
const SIZE: usize = 4096;

/// Whoever takes longer than this to live or to die will not.
const PATIENCE: Duration = Duration::from_secs(5);

/// The sign of life of one process, as another one sees it.
#[derive(Debug)]
pub struct BareDeath {
    channel: Channel,
}

impl BareDeath {
    /// Nobody lives yet.
    ///
    /// # Errors
    /// If the system refuses the memory.
    pub fn create() -> io::Result<Self> {
        let channel = Channel::create(SIZE, SIZE)?;
        Ok(Self { channel })
    }

    /// By which another process of the same user opens the memory, while this value lives.
    pub fn path(&self) -> PathBuf {
        let (process, file) = (std::process::id(), self.channel.memory().as_raw_fd());
        PathBuf::from(format!("/proc/{process}/fd/{file}"))
    }

    /// Waits until the other process lives.
    ///
    /// # Errors
    /// If it does not within 5 s.
    pub fn wait_for_life(&self) -> io::Result<()> {
        self.wait_for(Waited::Turn)?;
        self.channel.hand_to_host();
        Ok(())
    }

    /// Sleeps until it is dead.
    ///
    /// # Errors
    /// If it still lives after 5 s.
    pub fn wait_for_death(&self) -> io::Result<()> {
        self.wait_for(Waited::Dead)
    }

    /// In the other process, on its main thread and once: lives, and waits to be killed.
    ///
    /// # Errors
    /// If there is no such memory, or nobody has killed it within 5 s.
    pub fn live(path: &Path) -> io::Result<()> {
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        if file.metadata()?.len() < SIZE as u64 {
            return Err(io::Error::other("this is no shared memory of a life"));
        }
        // Never unmapped: the kernel looks at it when the process dies.
        let channel = Box::leak(Box::new(Channel::open(file.into(), SIZE, SIZE)?));
        SignsOfLife::new()?.show(channel);
        channel.hand_to_container();
        std::thread::sleep(PATIENCE);
        Err(io::Error::other("nobody has killed this process"))
    }

    fn wait_for(&self, expected: Waited) -> io::Result<()> {
        match self.channel.wait_for_host(PATIENCE) {
            waited if waited == expected => Ok(()),
            waited => Err(io::Error::other(format!(
                "{waited:?} instead of {expected:?} of a process that is to be killed"
            ))),
        }
    }
}
