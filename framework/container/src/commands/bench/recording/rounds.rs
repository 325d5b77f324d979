//! One round: the application without a recording and with one, and the processor time of both.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::RecordingArguments;

/// In which everything is loaded, and caches and branch predictors have seen the work.
const WARM_UP: Duration = Duration::from_secs(2);

/// What a run has to itself before it is asked to end.
const SPARE: Duration = Duration::from_secs(2);

/// Much longer than a run needs to end in order.
const END_LIMIT: Duration = Duration::from_secs(30);

/// The thread that moves the simulated world.
const WORLD: &str = "world";

/// Processor time of one round, in milliseconds of each second.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Round {
    /// All threads of the container but that of the world.
    without_ms_per_s: f64,
    /// The same, with a recording.
    with_ms_per_s: f64,
    /// Of that the thread that writes.
    writer_ms_per_s: f64,
}

impl Round {
    /// How much more it is with a recording, in percent.
    pub(super) fn cost_percent(&self) -> f64 {
        100.0 * (self.with_ms_per_s / self.without_ms_per_s - 1.0)
    }

    /// Without, with, and of that the writer.
    pub(super) fn figures(&self) -> [f64; 3] {
        [
            self.without_ms_per_s,
            self.with_ms_per_s,
            self.writer_ms_per_s,
        ]
    }
}

/// Measures one round; which of the two comes first changes from round to round.
pub(super) fn measure(
    arguments: &RecordingArguments,
    file: &Path,
    number: usize,
    duration: Duration,
) -> io::Result<Round> {
    let without = || usage(arguments, None, duration);
    let with = || usage(arguments, Some(file), duration);
    let (without, with) = if number.is_multiple_of(2) {
        (without()?, with()?)
    } else {
        let with = with()?;
        (without()?, with)
    };
    Ok(Round {
        without_ms_per_s: of_robot(&without),
        with_ms_per_s: of_robot(&with),
        writer_ms_per_s: with.get("recording").copied().unwrap_or_default(),
    })
}

fn of_robot(threads: &BTreeMap<String, f64>) -> f64 {
    let threads = threads.iter().filter(|(name, _)| *name != WORLD);
    threads.map(|(_, milliseconds)| milliseconds).sum()
}

/// Processor time by name of thread, in milliseconds of each second.
fn usage(
    arguments: &RecordingArguments,
    file: Option<&Path>,
    duration: Duration,
) -> io::Result<BTreeMap<String, f64>> {
    let seconds = (WARM_UP + duration + SPARE).as_secs();
    let mut command = Command::new(std::env::current_exe()?);
    command.arg("run").arg(&arguments.application).args([
        "--clock",
        "real",
        "--for",
        &format!("{seconds}s"),
    ]);
    for folder in &arguments.library_path {
        command.arg("--library-path").arg(folder);
    }
    if let Some(file) = file {
        command.arg("--record").arg(file);
    }
    let child = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::inherit())
        .spawn()?;
    let mut run = Run(child);
    std::thread::sleep(WARM_UP);
    let (begin, earlier) = (Instant::now(), run.threads()?);
    std::thread::sleep(duration);
    let (end, later) = (Instant::now(), run.threads()?);
    run.end()?;
    let seconds = (end - begin).as_secs_f64();
    let mut used = BTreeMap::new();
    for (thread, (name, time_ns)) in later {
        let before_ns = earlier.get(&thread).map_or(0, |(_, time_ns)| *time_ns);
        let milliseconds = time_ns.saturating_sub(before_ns) as f64 / 1e6;
        *used.entry(name).or_default() += milliseconds / seconds;
    }
    Ok(used)
}

/// A run; it ends with this at the latest.
struct Run(Child);

impl Run {
    /// Name and processor time in nanoseconds of every thread, by its number.
    fn threads(&self) -> io::Result<BTreeMap<String, (String, u64)>> {
        let mut threads = BTreeMap::new();
        for entry in fs::read_dir(format!("/proc/{}/task", self.0.id()))? {
            let folder = entry?.path();
            let name = fs::read_to_string(folder.join("comm"))?.trim().to_owned();
            let text = fs::read_to_string(folder.join("schedstat"))?;
            let time_ns = text.split_whitespace().next();
            let time_ns = time_ns.and_then(|it| it.parse().ok()).ok_or_else(|| {
                io::Error::other("the kernel does not tell processor time (schedstat)")
            })?;
            threads.insert(folder.display().to_string(), (name, time_ns));
        }
        Ok(threads)
    }

    fn end(&mut self) -> io::Result<()> {
        let deadline = Instant::now() + SPARE + END_LIMIT;
        while Instant::now() < deadline {
            match self.0.try_wait()? {
                Some(status) if status.success() => return Ok(()),
                Some(status) => return Err(io::Error::other(format!("a run ended with {status}"))),
                None => std::thread::sleep(Duration::from_millis(10)),
            }
        }
        Err(io::Error::other("a run did not end"))
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        // Fails if it has ended, as it should.
        let _ended = self.0.kill();
        let _reaped = self.0.wait();
    }
}
