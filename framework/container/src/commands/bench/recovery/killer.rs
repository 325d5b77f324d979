//! Who kills hosts from outside while they run a callback: for each fault one, as nobody in the
//! container would.

use std::fs;
use std::io;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use container::system::System;
use rustix::process::{Pid, PidfdFlags, Signal, pidfd_open, pidfd_send_signal};

use super::real_time::{PRIORITY, ask_for_real_time};

/// Often enough that many looks fall into a callback that is to be killed.
const LOOK_PERIOD: Duration = Duration::from_micros(100);

/// A thread that computes at so many looks in a row is in such a callback; others take a tenth of
/// that.
const BUSY_LOOKS: u32 = 4;

/// Whoever takes longer than this has another host by now.
const OUTDATED: Duration = Duration::from_millis(200);

/// The policy in `/proc/PID/task/TID/stat`, counted from the state (proc(5): fields 41 and 3).
const POLICY: usize = 38;
const SCHED_FIFO: &str = "1";

/// Kills the host of each of the components in turn, when it is in a callback that takes long, until
/// `done`. When it did, for each of them: just before, by the container's clock, in nanoseconds.
pub(super) fn kill_in_turn(system: &System, names: &[String], done: &AtomicBool) -> Vec<Vec<u64>> {
    // Where it is refused executors have none either.
    let real_time = ask_for_real_time(PRIORITY + 1);
    let mut all_ns = vec![Vec::new(); names.len()];
    while !done.load(Ordering::Acquire) {
        for (name, times_ns) in names.iter().zip(&mut all_ns) {
            let Some(host) = wait_for_callback(name, real_time, done) else {
                return all_ns;
            };
            let now_ns = system.now().as_nanos();
            // It is killed in its callback unless somebody was faster.
            if pidfd_send_signal(&host.process, Signal::KILL).is_ok() {
                times_ns.push(u64::try_from(now_ns).unwrap_or(u64::MAX));
            }
        }
    }
    all_ns
}

/// A process that runs an instance of a component.
struct Host {
    process: OwnedFd,
    /// Of the instance's thread.
    stat: PathBuf,
    busy_looks: u32,
}

/// The component's host, once it is in a callback that takes long; none when `done`.
fn wait_for_callback(component: &str, real_time: bool, done: &AtomicBool) -> Option<Host> {
    while !done.load(Ordering::Acquire) {
        let mut hosts = hosts_of(component).unwrap_or_default();
        let found = Instant::now();
        while found.elapsed() < OUTDATED && !done.load(Ordering::Acquire) {
            for host in &mut hosts {
                let busy = computes(&host.stat, real_time);
                host.busy_looks = if busy { host.busy_looks + 1 } else { 0 };
            }
            if let Some(index) = hosts.iter().position(|it| it.busy_looks >= BUSY_LOOKS) {
                return Some(hosts.swap_remove(index));
            }
            std::thread::sleep(LOOK_PERIOD);
        }
    }
    None
}

/// Whether a thread computes, at the executor's priority if there is one: who stands by and is being
/// prepared does not.
fn computes(stat: &Path, real_time: bool) -> bool {
    let text = fs::read_to_string(stat).unwrap_or_default();
    is_computing(&text, real_time)
}

fn is_computing(stat: &str, real_time: bool) -> bool {
    // The name before it may contain anything.
    let after_name = stat.rsplit_once(") ").map_or("", |(_, rest)| rest);
    let mut fields = after_name.split(' ');
    let running = fields.next() == Some("R");
    running && (!real_time || fields.nth(POLICY - 1) == Some(SCHED_FIFO))
}

/// The children of this process that have a thread of this name, as hosts name those of instances.
fn hosts_of(component: &str) -> io::Result<Vec<Host>> {
    let mut hosts = Vec::new();
    for task in fs::read_dir("/proc/self/task")? {
        let children = fs::read_to_string(task?.path().join("children")).unwrap_or_default();
        let numbers = children.split_whitespace().filter_map(|it| it.parse().ok());
        for process in numbers.filter_map(Pid::from_raw) {
            hosts.extend(host_of(component, process).ok().flatten());
        }
    }
    Ok(hosts)
}

fn host_of(component: &str, process: Pid) -> io::Result<Option<Host>> {
    let descriptor = pidfd_open(process, PidfdFlags::empty())?;
    let tasks = format!("/proc/{}/task", process.as_raw_nonzero());
    for task in fs::read_dir(tasks)? {
        let folder = task?.path();
        let name = fs::read_to_string(folder.join("comm")).unwrap_or_default();
        if name.trim_end() == component {
            return Ok(Some(Host {
                process: descriptor,
                stat: folder.join("stat"),
                busy_looks: 0,
            }));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_computes_is_told_by_state_and_policy() {
        let stat = |state: &str, policy: &str| {
            let between = "0 ".repeat(POLICY - 1);
            format!("7 (a) R b) {state} {between}{policy} 0 0\n")
        };
        for (state, policy, real_time, expected) in [
            ("R", "1", true, true),
            ("R", "0", true, false),
            ("R", "0", false, true),
            ("S", "1", true, false),
            ("S", "0", false, false),
        ] {
            let stat = stat(state, policy);
            assert_eq!(is_computing(&stat, real_time), expected, "{stat}");
        }
        assert!(!is_computing("", false));
    }
}
