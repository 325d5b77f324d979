//! Bytes that keep actuators safe while no container runs.

use std::fs::File;
use std::io::Write as _;
use std::time::Duration;

use system_model::rules::SafeStateRule;

use crate::device;

/// The safe states of all actuators that have one.
#[derive(Debug)]
pub(super) struct SafeStates(Vec<SafeState>);

#[derive(Debug)]
struct SafeState {
    rule: SafeStateRule,
    /// When it is written next; none while a container runs.
    due: Option<Duration>,
    /// Open only while no container runs.
    device: Option<File>,
    /// Why it was not written, if that is new.
    complaint: Option<String>,
    complained: bool,
}

impl SafeStates {
    /// None of them is written yet.
    pub(super) fn new(rules: Vec<SafeStateRule>) -> Self {
        let idle = |rule| SafeState {
            rule,
            due: None,
            device: None,
            complaint: None,
            complained: false,
        };
        Self(rules.into_iter().map(idle).collect())
    }

    /// No container runs from `now` on.
    pub(super) fn hold(&mut self, now: Duration) {
        for state in &mut self.0 {
            state.due.get_or_insert(now);
        }
    }

    /// A container runs: the devices are its own again.
    pub(super) fn release(&mut self) {
        for state in &mut self.0 {
            state.due = None;
            state.device = None;
            state.complained = false;
        }
    }

    /// When the next one is due.
    pub(super) fn due(&self) -> Option<Duration> {
        self.0.iter().filter_map(|state| state.due).min()
    }

    /// Writes all that are due `now`.
    pub(super) fn write(&mut self, now: Duration) {
        for state in &mut self.0 {
            if let Some(due) = state.due
                && due <= now
            {
                state.write();
                // Late ones are not made up for.
                state.due = Some((due + state.rule.period).max(now));
            }
        }
    }

    /// The names of the devices.
    pub(super) fn devices(&self) -> Vec<&str> {
        let rules = self.0.iter().map(|state| &state.rule);
        rules.map(|rule| rule.device.as_str()).collect()
    }

    /// Why devices cannot be written, each once for each time without a container.
    pub(super) fn complaints(&mut self) -> impl Iterator<Item = String> {
        self.0.iter_mut().filter_map(|state| state.complaint.take())
    }
}

impl SafeState {
    fn write(&mut self) {
        if let Err(reason) = self.try_write() {
            // It may have been unplugged: opened anew when it is due next.
            self.device = None;
            if !std::mem::replace(&mut self.complained, true) {
                self.complaint = Some(reason);
            }
        }
    }

    fn try_write(&mut self) -> Result<(), String> {
        let name = &self.rule.device;
        if self.device.is_none() {
            let opened = device::open(name, None);
            let opened = opened.map_err(|error| error.to_string())?;
            self.device = Some(opened.into_descriptor().into());
        }
        let Some(device) = &mut self.device else {
            return Ok(());
        };
        // Never waits. What does not fit is not written later: the next one comes whole.
        match device.write(&self.rule.bytes) {
            Ok(count) if count == self.rule.bytes.len() => Ok(()),
            Ok(count) => Err(format!("device '{name}' took {count} bytes only")),
            Err(error) => Err(format!("device '{name}' takes no safe state: {error}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use nix::fcntl::OFlag;
    use nix::pty::{grantpt, posix_openpt, ptsname_r, unlockpt};

    use super::*;

    fn at(milliseconds: u64) -> Duration {
        Duration::from_millis(milliseconds)
    }

    fn states(device: &std::path::Path) -> SafeStates {
        SafeStates::new(vec![SafeStateRule {
            device: device.display().to_string(),
            bytes: vec![2, 16],
            period: at(50),
        }])
    }

    #[test]
    fn bytes_are_written_every_period_while_no_container_runs() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut states = states(file.path());
        let mut written = Vec::new();
        let steps = [
            ("run", 0),
            ("dead", 100),
            ("dead", 120),
            ("dead", 149),
            ("dead", 150),
            // Too late for two of them.
            ("dead", 320),
            ("run", 330),
            ("run", 400),
            ("dead", 500),
        ];
        for (what, now) in steps {
            match what {
                "dead" => states.hold(at(now)),
                _ => states.release(),
            }
            states.write(at(now));
            written.push(std::fs::metadata(file.path()).unwrap().len() / 2);
        }
        // Opened anew, a file is written from its beginning.
        assert_eq!(written, [0, 1, 1, 1, 2, 3, 3, 3, 3]);
        let bytes = std::fs::read(file.path()).unwrap();
        assert_eq!(bytes, [2, 16].repeat(3));
    }

    #[test]
    fn a_terminal_that_nobody_reads_holds_nobody_up() {
        let flags = OFlag::O_RDWR | OFlag::O_NOCTTY | OFlag::O_NONBLOCK | OFlag::O_CLOEXEC;
        let mut master = posix_openpt(flags).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let device = ptsname_r(&master).unwrap();
        let mut states = states(device.as_ref());
        states.hold(at(0));
        // More than a terminal holds for its reader.
        let writes = 100_000;
        for write in 0..writes {
            states.write(at(50 * write));
        }
        assert!(states.complaints().next().is_some(), "it took all of that");
        let mut received = [0; 64];
        let count = master.read(&mut received).unwrap();
        assert_eq!(received[..count], [2, 16].repeat(count / 2));
    }

    #[test]
    fn a_device_that_is_not_there_is_complained_of_once() {
        let folder = tempfile::tempdir().unwrap();
        let device = folder.path().join("ttyUSB0");
        let mut states = states(&device);
        states.hold(at(0));
        states.write(at(0));
        let complaints: Vec<String> = states.complaints().collect();
        assert!(complaints[0].contains("ttyUSB0"), "{complaints:?}");
        states.write(at(50));
        assert_eq!(states.complaints().count(), 0);
        std::fs::write(&device, "").unwrap();
        states.write(at(100));
        assert_eq!(std::fs::read(&device).unwrap(), [2, 16], "it is back");
        states.release();
        assert_eq!(states.due(), None);
    }
}
