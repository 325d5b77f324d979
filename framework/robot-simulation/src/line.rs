//! The device end of a byte line that a component has opened.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::fs::OpenOptionsExt;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};

use nix::fcntl::OFlag;
use nix::pty::{PtyMaster, grantpt, posix_openpt, ptsname_r, unlockpt};
use nix::sys::termios::{FlushArg, SetArg, cfmakeraw, tcflush, tcgetattr, tcsetattr};

/// What carries the bytes of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// A pseudo-terminal: to the component a serial port like any other. For real time only, since
    /// the kernel moves its bytes at times of its own.
    PseudoTerminal,
    /// A socket pair: the same bytes at once.
    InProcess,
}

/// The device end of one line.
///
/// Nothing here ever waits. A frame that does not fit is dropped whole and counted; one that fits
/// in part is finished before the next.
#[derive(Debug, Default)]
pub(crate) struct Line {
    end: Option<End>,
    unfinished: Vec<u8>,
    dropped_frames: u64,
    unplugged: bool,
}

#[derive(Debug)]
enum End {
    InProcess(UnixStream),
    PseudoTerminal(PseudoTerminal),
}

#[derive(Debug)]
struct PseudoTerminal {
    master: PtyMaster,
    /// Kept open so that the line keeps its settings between two openings.
    slave: File,
    slave_path: PathBuf,
}

impl Line {
    /// A fresh end for a component. An older end in the same process is cut off.
    pub(crate) fn open(&mut self, transport: Transport) -> io::Result<OwnedFd> {
        if self.unplugged {
            return Err(io::Error::new(
                io::ErrorKind::NotFound,
                "the line is unplugged",
            ));
        }
        self.unfinished.clear();
        match transport {
            Transport::InProcess => {
                let (device, component) = UnixStream::pair()?;
                device.set_nonblocking(true)?;
                component.set_nonblocking(true)?;
                self.end = Some(End::InProcess(device));
                Ok(component.into())
            }
            Transport::PseudoTerminal => {
                let terminal = match self.end.take() {
                    Some(End::PseudoTerminal(terminal)) => terminal,
                    _ => PseudoTerminal::new()?,
                };
                let component = terminal.open_slave();
                self.end = Some(End::PseudoTerminal(terminal));
                component
            }
        }
    }

    /// Where the component's end appears in the file system.
    pub(crate) fn slave_path(&self) -> Option<&Path> {
        match &self.end {
            Some(End::PseudoTerminal(terminal)) => Some(&terminal.slave_path),
            _ => None,
        }
    }

    pub(crate) fn is_open(&self) -> bool {
        self.end.is_some()
    }

    pub(crate) fn dropped_frames(&self) -> u64 {
        self.dropped_frames
    }

    /// Pulls the plug: the component sees the end of its line and cannot open it again.
    pub(crate) fn unplug(&mut self) {
        self.end = None;
        self.unplugged = true;
    }

    pub(crate) fn plug_in(&mut self) {
        self.unplugged = false;
    }

    /// Bytes that have arrived, as many as fit into `buffer`.
    pub(crate) fn receive<'a>(&mut self, buffer: &'a mut [u8]) -> &'a [u8] {
        let received = match &mut self.end {
            Some(End::InProcess(stream)) => stream.read(buffer),
            Some(End::PseudoTerminal(terminal)) => terminal.master.read(buffer),
            None => Ok(0),
        };
        // A line that fails carries nothing, as a pulled plug does; the component notices.
        &buffer[..received.unwrap_or(0)]
    }

    /// Sends a whole frame or drops it.
    pub(crate) fn send(&mut self, frame: &[u8]) {
        self.finish();
        if !self.is_open() {
            return;
        }
        if !self.unfinished.is_empty() {
            self.dropped_frames += 1;
            return;
        }
        match self.write(frame) {
            0 => self.dropped_frames += 1,
            written => self.unfinished.extend_from_slice(&frame[written..]),
        }
    }

    /// Sends what is left of the frame before.
    pub(crate) fn finish(&mut self) {
        if !self.unfinished.is_empty() {
            let unfinished = std::mem::take(&mut self.unfinished);
            let written = self.write(&unfinished);
            self.unfinished.extend_from_slice(&unfinished[written..]);
        }
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let written = match &mut self.end {
            Some(End::InProcess(stream)) => stream.write(bytes),
            Some(End::PseudoTerminal(terminal)) => terminal.master.write(bytes),
            None => Ok(0),
        };
        written.unwrap_or(0)
    }
}

impl PseudoTerminal {
    fn new() -> io::Result<Self> {
        let flags = OFlag::O_RDWR | OFlag::O_NOCTTY | OFlag::O_NONBLOCK | OFlag::O_CLOEXEC;
        let master = posix_openpt(flags)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        let slave_path = PathBuf::from(ptsname_r(&master)?);
        let slave = open_terminal(&slave_path)?;
        let mut settings = tcgetattr(&slave)?;
        cfmakeraw(&mut settings);
        tcsetattr(&slave, SetArg::TCSANOW, &settings)?;
        Ok(Self {
            master,
            slave,
            slave_path,
        })
    }

    /// Opened anew, without what was on its way to or from an earlier opening.
    fn open_slave(&self) -> io::Result<OwnedFd> {
        tcflush(&self.slave, FlushArg::TCIOFLUSH)?;
        Ok(open_terminal(&self.slave_path)?.into())
    }
}

/// The standard library adds close-on-exec.
fn open_terminal(path: &Path) -> io::Result<File> {
    let flags = OFlag::O_NOCTTY | OFlag::O_NONBLOCK;
    OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags(flags.bits())
        .open(path)
}
