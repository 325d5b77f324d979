//! Devices that components open by name: of the simulated world, or of the machine.
#![allow(unsafe_code)] // takes a descriptor back that was given away

use std::fs::{File, OpenOptions};
use std::io::{self, IsTerminal as _};
use std::os::fd::{AsRawFd as _, FromRawFd as _, IntoRawFd as _, OwnedFd};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::PathBuf;

use nix::sys::termios::{self, BaudRate, SetArg};

use crate::world::World;

/// Names of devices of the simulated world start with this.
const SIMULATED: &str = "simulated:";

/// An open device that has not been given away yet.
#[derive(Debug)]
pub struct OpenDevice {
    descriptor: OwnedFd,
    /// Where a simulated device stands among the machine's, if it does.
    pub path: Option<PathBuf>,
}

/// Why a device does not open.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// A simulated device without a world.
    #[error(
        "device '{0}' is simulated, but the application has no <world>\n  help: add <world><reference>...</reference></world>, or set the property to a real device such as /dev/ttyUSB0"
    )]
    NoWorld(String),
    /// The world refuses.
    #[error(
        "device '{name}' does not open: {error}\n  help: the world has 'simulated:motion_board' and 'simulated:camera'; is it plugged in?"
    )]
    Simulated {
        /// The name.
        name: String,
        /// Why.
        error: io::Error,
    },
    /// The machine refuses.
    #[error(
        "device '{name}' does not open: {error}\n  help: is it plugged in, and may this user open it (group dialout)?"
    )]
    Machine {
        /// The path.
        name: String,
        /// Why.
        error: io::Error,
    },
}

/// Opens a device of the machine, or of the world that a component's application drives in.
///
/// # Errors
/// If there is none of that name or it does not open.
pub fn open(name: &str, world: Option<&World>) -> Result<OpenDevice, DeviceError> {
    let Some(simulated) = name.strip_prefix(SIMULATED) else {
        return open_path(name).map_err(|error| DeviceError::Machine {
            name: name.to_owned(),
            error,
        });
    };
    let world = world.ok_or_else(|| DeviceError::NoWorld(name.to_owned()))?;
    let opened = world.open(simulated);
    opened
        .map(|(descriptor, path)| OpenDevice { descriptor, path })
        .map_err(|error| DeviceError::Simulated {
            name: name.to_owned(),
            error,
        })
}

impl OpenDevice {
    /// The descriptor's number; still owned here.
    pub fn number(&self) -> i32 {
        self.descriptor.as_raw_fd()
    }

    /// The descriptor, for the container's own use.
    pub fn into_descriptor(self) -> OwnedFd {
        self.descriptor
    }

    /// The component owns the descriptor from now on.
    pub fn give_away(self) {
        let _now_theirs = self.descriptor.into_raw_fd();
    }
}

/// A device that was given away under this number, taken back: for a component in another process.
pub(crate) fn taken_back(number: i32) -> OwnedFd {
    // SAFETY: given away by `OpenDevice::give_away` to nobody but the caller.
    unsafe { OwnedFd::from_raw_fd(number) }
}

/// Opens a device file; a terminal is set to raw 115200 8N1, as motion boards speak.
fn open_path(path: &str) -> io::Result<OpenDevice> {
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags(libc::O_NONBLOCK | libc::O_NOCTTY | libc::O_CLOEXEC)
        .open(path)?;
    if file.is_terminal() {
        make_raw(&file)?;
    }
    Ok(OpenDevice {
        descriptor: file.into(),
        path: None,
    })
}

fn make_raw(terminal: &File) -> io::Result<()> {
    let mut settings = termios::tcgetattr(terminal)?;
    termios::cfmakeraw(&mut settings);
    termios::cfsetspeed(&mut settings, BaudRate::B115200)?;
    termios::tcsetattr(terminal, SetArg::TCSANOW, &settings)?;
    Ok(())
}
