//! One run of `steadfast run` in a process of its own, as an integrator would start it, measured by
//! its stopwatches and looked at from outside.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde::Deserialize;
use serde_json::Value;

use super::application::{self, Chain};
use super::memory::{self, Footprint};

/// Much longer than any run of the study takes; what takes longer hangs.
const RUN_LIMIT: Duration = Duration::from_secs(120);

/// How often the memory is looked at, and how often in a row it must be the same to be settled:
/// standbys are prepared in the background after the start.
const LOOK_PERIOD: Duration = Duration::from_millis(100);
const SETTLED_LOOKS: u32 = 5;

/// By which clock the chain runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pace {
    /// Simulated time: one cycle after the other, as fast as it goes. So many cycles.
    Free(u32),
    /// Real time, a cycle in each period. So long.
    Periodic(Duration),
}

/// What a run was found to be.
#[derive(Debug)]
pub(super) struct Trial {
    /// From the beginning of one cycle to that of the next, in ns.
    pub(super) cycles_ns: Vec<u64>,
    /// From the write of the first stopwatch to the read of the last one, in ns.
    pub(super) passages_ns: Vec<u64>,
    /// How long it took until the last component worked.
    pub(super) start: Start,
    /// What it took when it had settled, if that was asked for.
    pub(super) footprint: Option<Footprint>,
}

/// The time from the start of the process to the end of the first cycle, in ms.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Start {
    /// Process, reading and checking.
    pub(super) read_ms: f64,
    /// Loading, comparing and connecting.
    pub(super) load_ms: f64,
    /// Constructing, initialising and starting.
    pub(super) bring_up_ms: f64,
    /// Threads, and the first cycle.
    pub(super) launch_ms: f64,
}

impl Start {
    /// All of it.
    pub(super) fn total_ms(&self) -> f64 {
        self.read_ms + self.load_ms + self.bring_up_ms + self.launch_ms
    }
}

/// What a stopwatch writes.
#[derive(Debug, Deserialize)]
struct Record {
    first_ns: u64,
    first_by_container_ns: u64,
    cycles_ns: Vec<u64>,
    passages_ns: Vec<u64>,
}

/// Runs a chain to its end.
///
/// # Errors
/// If it does not run, or anything in it is a fault: then nothing was measured.
pub(super) fn run(chain: &Chain, pace: Pace) -> io::Result<Trial> {
    attempt(chain, pace, false)
}

/// Runs a chain in real time until its memory has settled.
///
/// # Errors
/// As [`run`].
pub(super) fn settle(chain: &Chain) -> io::Result<Trial> {
    attempt(chain, Pace::Periodic(RUN_LIMIT), true)
}

fn attempt(chain: &Chain, pace: Pace, settles: bool) -> io::Result<Trial> {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    let files = application::write(chain, folder)?;
    let mut command = Command::new(std::env::current_exe()?);
    command.arg("run").arg(&files.application);
    command.arg("--rules").arg(&files.rules);
    let (clock, milliseconds) = match pace {
        Pace::Free(cycles) => ("simulated", u128::from(cycles * application::PERIOD_MS)),
        Pace::Periodic(duration) => ("real", duration.as_millis()),
    };
    command.args(["--clock", clock, "--for", &format!("{milliseconds}ms")]);
    command.arg("--events").arg(folder.join("events.jsonl"));
    command.arg("--summary").arg(folder.join("summary.json"));
    let spawned_ns = monotonic_ns();
    let running = Running::spawn(command, folder.join("stderr.txt"))?;
    let footprint = settles.then(|| running.settled());
    running.finish(settles)?;
    refuse_faults(&read_json(&folder.join("summary.json"))?)?;
    let sender: Record = serde_json::from_value(read_json(&files.sender)?)?;
    let receiver: Record = serde_json::from_value(read_json(&files.receiver)?)?;
    Ok(Trial {
        start: start(&receiver, spawned_ns, &folder.join("events.jsonl"))?,
        cycles_ns: sender.cycles_ns,
        passages_ns: receiver.passages_ns,
        footprint,
    })
}

/// A run that is under way; it ends with this at the latest.
struct Running {
    child: Child,
    /// What it complained of; a pipe that nobody reads would stop it.
    complaints: PathBuf,
    deadline: Instant,
}

impl Running {
    fn spawn(mut command: Command, complaints: PathBuf) -> io::Result<Self> {
        let child = command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(File::create(&complaints)?)
            .spawn()?;
        Ok(Self {
            child,
            complaints,
            deadline: Instant::now() + RUN_LIMIT,
        })
    }

    /// Waits until memory does not change any more. A run that has ended instead says why when it
    /// is waited for.
    fn settled(&self) -> Footprint {
        let (mut last, mut same) = (Footprint::default(), 0);
        while same < SETTLED_LOOKS && Instant::now() < self.deadline {
            std::thread::sleep(LOOK_PERIOD);
            let Ok(now) = memory::footprint(self.child.id()) else {
                break;
            };
            same = if now.is_like(&last) { same + 1 } else { 0 };
            last = now;
        }
        last
    }

    /// Waits for its end, asking for it if `stop`.
    fn finish(mut self, stop: bool) -> io::Result<()> {
        if stop && let Some(process) = rustix::process::Pid::from_raw(self.child.id().cast_signed())
        {
            rustix::process::kill_process(process, rustix::process::Signal::TERM)?;
        }
        let status = loop {
            if let Some(status) = self.child.try_wait()? {
                break status;
            }
            if Instant::now() > self.deadline {
                return Err(io::Error::other(format!(
                    "a run did not end within {} s",
                    RUN_LIMIT.as_secs()
                )));
            }
            std::thread::sleep(Duration::from_millis(1));
        };
        if status.success() {
            return Ok(());
        }
        let said = std::fs::read_to_string(&self.complaints)?;
        Err(io::Error::other(format!(
            "a run ended with {status}:\n{said}"
        )))
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Fails if it has ended, as it should.
        let _ended = self.child.kill();
        let _reaped = self.child.wait();
    }
}

/// A chain that had faults was not one in which nothing failed.
fn refuse_faults(summary: &Value) -> io::Result<()> {
    let components = summary["components"].as_object();
    for (name, component) in components.into_iter().flatten() {
        if component["faults"] != 0 || component["state"] != "ACTIVE" {
            return Err(io::Error::other(format!(
                "component '{name}' of a chain without faults: {component}"
            )));
        }
    }
    Ok(())
}

fn start(last: &Record, spawned_ns: u64, events: &Path) -> io::Result<Start> {
    let text = std::fs::read_to_string(events)?;
    let states = text.lines().filter_map(|line| {
        let event: Value = serde_json::from_str(line).ok()?;
        (event["event"] == "state").then(|| Some((event["t_ns"].as_u64()?, event["to"].clone())))?
    });
    let (mut ready_ns, mut active_ns) = (None, 0);
    for (t_ns, to) in states {
        ready_ns.get_or_insert(t_ns);
        if to == "ACTIVE" {
            active_ns = t_ns;
        }
    }
    let ready_ns = ready_ns.unwrap_or_default();
    let whole_ns = last.first_ns.saturating_sub(spawned_ns);
    let milliseconds = |until: u64, since: u64| until.saturating_sub(since) as f64 / 1e6;
    Ok(Start {
        read_ms: milliseconds(whole_ns, last.first_by_container_ns),
        load_ms: milliseconds(ready_ns, 0),
        bring_up_ms: milliseconds(active_ns, ready_ns),
        launch_ms: milliseconds(last.first_by_container_ns, active_ns),
    })
}

fn read_json(path: &Path) -> io::Result<Value> {
    let text = std::fs::read(path)
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))?;
    Ok(serde_json::from_slice(&text)?)
}

fn monotonic_ns() -> u64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    let seconds = u64::try_from(time.tv_sec).unwrap_or_default();
    seconds * 1_000_000_000 + u64::try_from(time.tv_nsec).unwrap_or_default()
}
