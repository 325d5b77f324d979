//! The simulated world as a child of the parent's.

use std::ffi::OsStr;
use std::io::{self, ErrorKind, Read as _};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use super::judgement::End;
use super::messages::LINE_LIMIT;
use super::parent::PlannedWorld;
use super::process::{KILL_LIMIT, Process};
use crate::descriptor_line::DescriptorLine;
use crate::world::STANDS;

/// The hidden command of the binary that is a world.
const WORLD_COMMAND: &str = "world";

/// Reading a world and drawing an arena takes well under a second.
const STAND_LIMIT: Duration = Duration::from_secs(30);

/// A running world.
#[derive(Debug)]
pub(super) struct WorldProcess {
    process: Process,
    line: DescriptorLine,
}

/// Why there is no world.
#[derive(Debug)]
pub(super) enum NoWorld {
    /// It has said why, and ended with this exit code.
    Refused(u8),
    /// The system refuses.
    System(io::Error),
}

impl From<io::Error> for NoWorld {
    fn from(error: io::Error) -> Self {
        Self::System(error)
    }
}

impl WorldProcess {
    /// Starts a world and waits until it stands.
    pub(super) fn start(executable: &Path, world: &PlannedWorld) -> Result<Self, NoWorld> {
        let (here, there) = UnixStream::pair()?;
        let mut command = Command::new(executable);
        command
            .arg(WORLD_COMMAND)
            .arg(&world.file)
            .args(["--seed", &world.seed.to_string()])
            .args(["--parent", &std::process::id().to_string()])
            .env_remove(OsStr::new(super::service_manager::SOCKET_VARIABLE));
        let mut process = Process::start(&mut command, there.into())?;
        here.set_read_timeout(Some(STAND_LIMIT))?;
        let mut word = [0];
        match (&here).read(&mut word)? {
            1 if word == [STANDS] => Ok(Self {
                process,
                line: DescriptorLine::new(here, LINE_LIMIT)?,
            }),
            0 if process.ends_within(KILL_LIMIT) => Err(match process.reap()? {
                End::Code(code @ 1..=255) => NoWorld::Refused(u8::try_from(code).unwrap_or(1)),
                end => NoWorld::System(io::Error::other(end.to_string())),
            }),
            _ => Err(io::Error::from(ErrorKind::InvalidData).into()),
        }
    }

    /// The end of a fresh line to the world, for a container.
    pub(super) fn connect(&mut self) -> io::Result<UnixStream> {
        let (container, world) = UnixStream::pair()?;
        self.line.send(&(), Some(world.as_fd()))?;
        Ok(container)
    }
}

impl AsFd for WorldProcess {
    /// Readable once the world has ended.
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.process.as_fd()
    }
}
