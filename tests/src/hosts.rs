//! Host processes of a run, seen and harmed from outside.

use std::fs;
use std::path::Path;

use rustix::process::{Pid, Signal, kill_process};

/// Characters of a thread's name that the kernel keeps.
const THREAD_NAME: usize = 15;

/// A process that the container has started to run components in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Host {
    process: Pid,
    /// Each component runs on a thread that has its name.
    threads: Vec<String>,
}

impl Host {
    /// Whether a component (or one that stands by for it) runs there.
    pub fn runs(&self, component: &str) -> bool {
        let kept = &component[..component.len().min(THREAD_NAME)];
        self.threads.iter().any(|name| name == kept)
    }

    /// Its number.
    pub fn id(&self) -> i32 {
        self.process.as_raw_nonzero().get()
    }

    /// Sends a signal; whether the process was there.
    pub fn signal(&self, signal: Signal) -> bool {
        kill_process(self.process, signal).is_ok()
    }

    /// Whether it is gone, or waits for nothing but being reaped.
    pub fn is_gone(&self) -> bool {
        Process::read(self.process).is_none_or(|process| process.is_zombie)
    }
}

/// What the kernel says of a process.
struct Process {
    parent: i32,
    is_zombie: bool,
    /// In ticks of the kernel's clock.
    started: u64,
}

impl Process {
    fn read(process: Pid) -> Option<Self> {
        let id = process.as_raw_nonzero();
        let text = fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
        // The name stands in parentheses and may have spaces.
        let (_, rest) = text.rsplit_once(')')?;
        let mut words = rest.split_whitespace();
        let is_zombie = words.next()? == "Z";
        let parent = words.next()?.parse().ok()?;
        // Field 22 of the line; the parent was the fourth.
        let started = words.nth(17)?.parse().ok()?;
        Some(Self {
            parent,
            is_zombie,
            started,
        })
    }
}

/// All living children of a process, the oldest first.
pub(crate) fn hosts_of(container: u32) -> Vec<Host> {
    let is_child = |process: &Pid| {
        Process::read(*process)
            .is_some_and(|found| u32::try_from(found.parent) == Ok(container) && !found.is_zombie)
    };
    let mut children: Vec<Pid> = processes().into_iter().filter(is_child).collect();
    children.sort_by_key(|process| {
        let started = Process::read(*process).map(|found| found.started);
        (started, process.as_raw_nonzero())
    });
    let with_threads = children.into_iter().map(|process| Host {
        process,
        threads: threads(process),
    });
    with_threads.collect()
}

/// Processes with this text in their command line or their environment, zombies left out: they
/// have neither any more.
pub fn processes_that_mention(text: &str) -> Vec<i32> {
    let mentions = |process: &Pid| {
        let id = process.as_raw_nonzero();
        let has = |file: &str| {
            let content = fs::read(format!("/proc/{id}/{file}")).unwrap_or_default();
            content
                .windows(text.len())
                .any(|part| part == text.as_bytes())
        };
        has("cmdline") || has("environ")
    };
    let found = processes().into_iter().filter(mentions);
    found
        .map(|process| process.as_raw_nonzero().get())
        .collect()
}

/// Children of the calling process that are dead and not reaped.
pub fn zombies() -> usize {
    let own = std::process::id();
    let is_zombie = |process: &Pid| {
        Process::read(*process)
            .is_some_and(|found| u32::try_from(found.parent) == Ok(own) && found.is_zombie)
    };
    processes().into_iter().filter(is_zombie).count()
}

fn processes() -> Vec<Pid> {
    let number = |name: String| name.parse().ok().and_then(Pid::from_raw);
    names(Path::new("/proc"))
        .into_iter()
        .filter_map(number)
        .collect()
}

fn threads(process: Pid) -> Vec<String> {
    let folder = format!("/proc/{}/task", process.as_raw_nonzero());
    let name = |thread: String| {
        let name = fs::read_to_string(format!("{folder}/{thread}/comm")).ok()?;
        Some(name.trim_end().to_owned())
    };
    names(Path::new(&folder))
        .into_iter()
        .filter_map(name)
        .collect()
}

/// Names of what is in a folder; none of one that is gone.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect()
}
