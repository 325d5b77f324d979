//! What a service manager such as systemd is told (`sd_notify(3)`).
//!
//! Written here because the crates for it open the socket by its path alone, which leaves abstract
//! ones out, and may wait for a manager that does not read.

use std::ffi::OsStr;
use std::io;
use std::os::linux::net::SocketAddrExt as _;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::net::{SocketAddr, UnixDatagram};
use std::time::Duration;

/// Where the manager listens.
pub(super) const SOCKET_VARIABLE: &str = "NOTIFY_SOCKET";

/// Within which the manager wants to hear of a service, in microseconds.
pub(super) const WATCHDOG_VARIABLE: &str = "WATCHDOG_USEC";

/// Which process that goes for.
pub(super) const WATCHDOG_PROCESS_VARIABLE: &str = "WATCHDOG_PID";

/// The service manager that has started this process, or none.
#[derive(Debug, Default)]
pub(super) struct ServiceManager {
    socket: Option<UnixDatagram>,
    watchdog: Option<Watchdog>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Watchdog {
    period: Duration,
    due: Duration,
}

impl ServiceManager {
    /// The one that the environment speaks of.
    ///
    /// # Errors
    /// If it cannot be reached.
    pub(super) fn of_environment(now: Duration) -> io::Result<Self> {
        let text = |name| std::env::var(name).ok();
        let watchdog = watchdog_period(
            text(WATCHDOG_VARIABLE).as_deref(),
            text(WATCHDOG_PROCESS_VARIABLE).as_deref(),
            std::process::id(),
        );
        match std::env::var_os(SOCKET_VARIABLE) {
            Some(address) => Self::at(&address, watchdog, now),
            None => Ok(Self::default()),
        }
    }

    /// The one at this address, which wants to hear of the service every `watchdog`.
    fn at(address: &OsStr, watchdog: Option<Duration>, now: Duration) -> io::Result<Self> {
        let address = match address.as_bytes() {
            [b'@', name @ ..] => SocketAddr::from_abstract_name(name)?,
            path => SocketAddr::from_pathname(OsStr::from_bytes(path))?,
        };
        let socket = UnixDatagram::unbound()?;
        socket.connect_addr(&address)?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket: Some(socket),
            watchdog: watchdog.map(|period| Watchdog { period, due: now }),
        })
    }

    /// The application runs.
    pub(super) fn ready(&self) {
        self.tell("READY=1");
    }

    /// All stops.
    pub(super) fn stopping(&self) {
        self.tell("STOPPING=1");
    }

    /// What a person reads in `systemctl status`.
    pub(super) fn status(&self, status: &str) {
        self.tell(&format!("STATUS={}", status.replace('\n', " ")));
    }

    /// When its watchdog wants to hear that all is well.
    pub(super) fn due(&self) -> Option<Duration> {
        self.watchdog.map(|watchdog| watchdog.due)
    }

    /// All is well `now`.
    pub(super) fn feed(&mut self, now: Duration) {
        let Some(watchdog) = &mut self.watchdog else {
            return;
        };
        if watchdog.due <= now {
            watchdog.due = now + watchdog.period;
            self.tell("WATCHDOG=1");
        }
    }

    fn tell(&self, state: &str) {
        if let Some(socket) = &self.socket {
            // A manager that does not read hears the next one.
            let _unheard = socket.send(state.as_bytes());
        }
    }
}

/// Half of the time in which the manager wants to hear of this process, as it recommends.
fn watchdog_period(
    microseconds: Option<&str>,
    process: Option<&str>,
    this_process: u32,
) -> Option<Duration> {
    let microseconds: u64 = microseconds?.parse().ok()?;
    let is_meant = process.is_none_or(|process| process.parse() == Ok(this_process));
    (is_meant && microseconds > 0).then(|| Duration::from_micros(microseconds) / 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(socket: &UnixDatagram) -> Option<String> {
        let mut buffer = [0; 256];
        let length = socket.recv(&mut buffer).ok()?;
        Some(String::from_utf8_lossy(&buffer[..length]).into_owned())
    }

    #[test]
    fn it_hears_what_becomes_of_the_service() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("notify");
        let name = format!("@steadfast-test-{}", std::process::id());
        let abstract_address = SocketAddr::from_abstract_name(&name.as_bytes()[1..]).unwrap();
        for (socket, address) in [
            (UnixDatagram::bind(&path), path.as_os_str()),
            (
                UnixDatagram::bind_addr(&abstract_address),
                OsStr::new(&name),
            ),
        ] {
            let socket = socket.unwrap();
            socket.set_nonblocking(true).unwrap();
            let second = Duration::from_secs(1);
            let mut manager =
                ServiceManager::at(address, Some(2 * second), Duration::ZERO).unwrap();
            manager.ready();
            manager.status("runs\nwell");
            for now in [0, 1, 2, 3, 4] {
                manager.feed(now * second);
            }
            manager.stopping();
            let all: Vec<String> = std::iter::from_fn(|| heard(&socket)).collect();
            assert_eq!(
                all,
                [
                    "READY=1",
                    "STATUS=runs well",
                    "WATCHDOG=1",
                    "WATCHDOG=1",
                    "WATCHDOG=1",
                    "STOPPING=1"
                ]
            );
            assert_eq!(manager.due(), Some(6 * second));
        }
    }

    #[test]
    fn the_watchdog_of_another_process_is_not_ours() {
        for (microseconds, process, expected_ms) in [
            (Some("2000000"), None, Some(1000)),
            (Some("2000000"), Some("7"), Some(1000)),
            (Some("2000000"), Some("8"), None),
            (Some("2000000"), Some("x"), None),
            (Some("0"), None, None),
            (Some("soon"), None, None),
            (None, Some("7"), None),
        ] {
            let expected = expected_ms.map(Duration::from_millis);
            let period = watchdog_period(microseconds, process, 7);
            assert_eq!(period, expected, "{microseconds:?} {process:?}");
        }
    }
}
