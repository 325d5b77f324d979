//! A supervised run: a parent, its container, and perhaps its world, each a process.

use std::path::Path;
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};

use crate::watchdog::{Watched, until};

/// A container comes up in a second or two; a busy machine gets more.
const START_LIMIT: Duration = Duration::from_secs(60);

/// A process that was killed is gone in milliseconds.
const END_LIMIT: Duration = Duration::from_secs(30);

/// The processes of a supervised run.
pub struct Supervised {
    parent: Pid,
}

impl Supervised {
    /// Those below this parent.
    pub fn by(parent: &Watched) -> Self {
        Self {
            parent: parent.id(),
        }
    }

    /// The container, once there is one that is not `before`.
    ///
    /// # Panics
    /// If it does not come.
    pub fn container(&self, before: Option<Pid>) -> Pid {
        self.child("--supervised-by", before)
    }

    /// The simulated world, once there is one.
    ///
    /// # Panics
    /// If it does not come.
    pub fn world(&self) -> Pid {
        self.child("--parent", None)
    }

    fn child(&self, argument: &str, before: Option<Pid>) -> Pid {
        let mut found = None;
        let came = until(START_LIMIT, || {
            let mut children = children(self.parent).into_iter();
            found = children.find(|child| Some(*child) != before && has_argument(*child, argument));
            found.is_some()
        });
        assert!(came, "no child with {argument}");
        found.expect("it came")
    }

    /// How many files and sockets the parent has open.
    pub fn open_in_parent(&self) -> usize {
        let descriptors = std::fs::read_dir(folder(self.parent).join("fd"));
        descriptors.into_iter().flatten().count()
    }

    /// Processes that were called with this argument, whoever has started them.
    pub fn called_with(argument: &str) -> Vec<Pid> {
        let mut found = processes();
        found.retain(|process| has_argument(*process, argument));
        found
    }

    /// Sends a signal to a process of the run.
    ///
    /// # Panics
    /// If it is gone.
    pub fn signal(process: Pid, signal: Signal) {
        kill_process(process, signal).expect("it runs");
    }

    /// Waits until a process has ended, whether or not anyone has asked how.
    ///
    /// # Panics
    /// If it does not.
    pub fn assert_ends(process: Pid) {
        let ended = || matches!(state(process), None | Some('Z' | 'X'));
        assert!(until(END_LIMIT, ended), "process {process:?} is left");
    }
}

/// One-letter state of a process, as in `proc(5)`; none if there is no such process.
fn state(process: Pid) -> Option<char> {
    fields(process)?.first()?.chars().next()
}

/// The living children of a process.
fn children(parent: Pid) -> Vec<Pid> {
    let is_child = |process: &Pid| {
        let fields = fields(*process).unwrap_or_default();
        let of = fields.get(1).and_then(|parent| parent.parse().ok());
        of == Some(parent.as_raw_nonzero().get()) && fields[0] != "Z"
    };
    processes().into_iter().filter(is_child).collect()
}

fn processes() -> Vec<Pid> {
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    names
        .filter_map(|name| Pid::from_raw(name.parse().ok()?))
        .collect()
}

/// What stands behind the name of a process in `/proc/PROCESS/stat`: state, parent, group.
fn fields(process: Pid) -> Option<Vec<String>> {
    let stat = std::fs::read_to_string(folder(process).join("stat")).ok()?;
    let (_, behind) = stat.rsplit_once(')')?;
    Some(behind.split_whitespace().map(str::to_owned).collect())
}

fn has_argument(process: Pid, argument: &str) -> bool {
    let line = std::fs::read(folder(process).join("cmdline")).unwrap_or_default();
    let mut arguments = line.split(|byte| *byte == 0);
    arguments.any(|found| found == argument.as_bytes())
}

fn folder(process: Pid) -> std::path::PathBuf {
    Path::new("/proc").join(process.as_raw_nonzero().to_string())
}
