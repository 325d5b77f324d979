//! Child processes that cannot hang a test: every wait has a deadline, and who misses it is killed
//! and quoted.

use std::fmt;
use std::fs::File;
use std::io::{Read as _, Seek as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::hosts::{Host, hosts_of};

/// How often a child is looked at.
const POLL_PERIOD: Duration = Duration::from_millis(2);

/// A host starts within milliseconds; a busy machine gets more.
const HOST_LIMIT: Duration = Duration::from_secs(30);

/// The root of the repository.
pub fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the tests lie in a folder of the repository")
}

/// Waits until `holds`; false if it does not within `limit`.
pub fn until(limit: Duration, mut holds: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while !holds() {
        if start.elapsed() > limit {
            return false;
        }
        std::thread::sleep(POLL_PERIOD);
    }
    true
}

/// A child under watch; killed when dropped.
pub struct Watched {
    child: Child,
    words: String,
    /// In files: a pipe that nobody reads would stop the child.
    stdout: File,
    stderr: File,
}

/// How a child ended.
#[derive(Debug)]
pub struct Finished {
    /// Exit code; `None` if it died of a signal.
    pub code: Option<i32>,
    /// What it printed.
    pub stdout: String,
    /// What it complained of.
    pub stderr: String,
    words: String,
}

impl Watched {
    /// Starts a child.
    ///
    /// # Panics
    /// If it does not start.
    pub fn spawn(command: &mut Command) -> Self {
        let words = format!("{command:?}");
        let output = || {
            let file = tempfile::tempfile().expect("a file for the child's output");
            let copy = file.try_clone().expect("a second descriptor for it");
            (file, copy)
        };
        let ((stdout, child_stdout), (stderr, child_stderr)) = (output(), output());
        let child = command
            .stdin(Stdio::null())
            .stdout(child_stdout)
            .stderr(child_stderr)
            .spawn()
            .unwrap_or_else(|error| panic!("{words} does not start: {error}"));
        Self {
            child,
            words,
            stdout,
            stderr,
        }
    }

    /// Its number.
    ///
    /// # Panics
    /// If the system has none for it.
    pub fn id(&self) -> Pid {
        let id = i32::try_from(self.child.id()).expect("process ids are small");
        Pid::from_raw(id).expect("a child's id is not 0")
    }

    /// Sends a signal.
    ///
    /// # Panics
    /// If the child is gone.
    pub fn signal(&self, signal: Signal) {
        kill_process(self.id(), signal).expect("the child runs");
    }

    /// The processes that it runs components in.
    pub fn hosts(&self) -> Vec<Host> {
        hosts_of(self.child.id())
    }

    /// The one that a component runs in, once there is one.
    ///
    /// # Panics
    /// If there is none in time.
    pub fn host_of(&self, component: &str) -> Host {
        let mut found = None;
        let is_there = || {
            found = self.hosts().into_iter().find(|host| host.runs(component));
            found.is_some()
        };
        assert!(until(HOST_LIMIT, is_there), "no host runs '{component}'");
        found.expect("it was just found")
    }

    /// Whether it still runs.
    ///
    /// # Panics
    /// If the system cannot say.
    pub fn is_running(&mut self) -> bool {
        self.child
            .try_wait()
            .expect("a child can be asked")
            .is_none()
    }

    /// Waits for its end.
    ///
    /// # Panics
    /// If it does not end within `limit`; then it is killed.
    pub fn wait(mut self, limit: Duration) -> Finished {
        let ended = until(limit, || !self.is_running());
        if !ended {
            let _gone = self.child.kill();
        }
        let status = self.child.wait().expect("a child can be waited for");
        let finished = Finished {
            code: status.code(),
            stdout: content(&mut self.stdout),
            stderr: content(&mut self.stderr),
            words: std::mem::take(&mut self.words),
        };
        assert!(ended, "not done within {limit:?}: {finished}");
        finished
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        // Gone already, unless a test failed.
        let _gone = self.child.kill();
        let _reaped = self.child.wait();
    }
}

impl fmt::Display for Finished {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "{} ended with {:?}\n--- stdout\n{}\n--- stderr\n{}",
            self.words,
            self.code,
            end_of(&self.stdout),
            end_of(&self.stderr)
        )
    }
}

/// As much as a person reads.
fn end_of(text: &str) -> &str {
    const LONGEST_QUOTATION: usize = 5000;
    let start = text.ceil_char_boundary(text.len().saturating_sub(LONGEST_QUOTATION));
    &text[start..]
}

fn content(file: &mut File) -> String {
    let mut bytes = Vec::new();
    file.rewind().expect("the output can be read again");
    file.read_to_end(&mut bytes)
        .expect("the output can be read");
    String::from_utf8_lossy(&bytes).into_owned()
}
