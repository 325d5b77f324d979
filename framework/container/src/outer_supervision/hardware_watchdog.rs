//! A watchdog device of the machine: it resets the machine when it is not written to in time.

use std::fs::{File, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::time::Duration;

/// Watchdog devices wait for 10 s to a minute, some as short as a few seconds.
const PERIOD: Duration = Duration::from_millis(500);

/// Any byte but the magic one.
const ALIVE: [u8; 1] = [0];

/// Before the device is closed: that the machine is to go on without it.
const MAGIC_CLOSE: [u8; 1] = *b"V";

/// An armed watchdog. Dropped without [`HardwareWatchdog::disarm`] it resets the machine in time.
#[derive(Debug)]
pub(super) struct HardwareWatchdog {
    device: File,
    due: Duration,
}

impl HardwareWatchdog {
    /// Opens the device, which arms it.
    pub(super) fn arm(path: &Path, now: Duration) -> io::Result<Self> {
        let device = OpenOptions::new()
            .write(true)
            .custom_flags(libc::O_NONBLOCK | libc::O_CLOEXEC)
            .open(path)?;
        Ok(Self { device, due: now })
    }

    /// When it wants to be written to.
    pub(super) fn due(&self) -> Duration {
        self.due
    }

    /// All is well `now`.
    pub(super) fn feed(&mut self, now: Duration) {
        if self.due <= now {
            // What is refused is missing, as it should be of a watchdog that does not work.
            let _missing = self.device.write(&ALIVE);
            self.due = now + PERIOD;
        }
    }

    /// All has ended in order.
    pub(super) fn disarm(mut self) -> io::Result<()> {
        self.device.write_all(&MAGIC_CLOSE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_fed_in_time_and_disarmed_only_at_an_orderly_end() {
        for (disarmed, expected) in [(false, &[0, 0, 0][..]), (true, &[0, 0, 0, b'V'])] {
            let file = tempfile::NamedTempFile::new().unwrap();
            let mut watchdog = HardwareWatchdog::arm(file.path(), Duration::ZERO).unwrap();
            for now in [0, 100, 500, 999, 1000] {
                watchdog.feed(Duration::from_millis(now));
            }
            assert_eq!(watchdog.due(), Duration::from_millis(1500));
            if disarmed {
                watchdog.disarm().unwrap();
            } else {
                drop(watchdog);
            }
            assert_eq!(std::fs::read(file.path()).unwrap(), expected);
        }
    }

    #[test]
    fn a_device_that_is_not_there_is_no_watchdog() {
        let folder = tempfile::tempdir().unwrap();
        assert!(HardwareWatchdog::arm(&folder.path().join("watchdog"), Duration::ZERO).is_err());
        assert_eq!(folder.path().read_dir().unwrap().count(), 0, "nor made one");
    }
}
