//! A load of known size on all processors, at normal priority, made by a process of its own: to the
//! caches and to the scheduler it is a stranger, as other programs of a robot are.

use std::io;
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use clap::Args;
use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

use super::offspring::end_with_parent;
use super::processor_time::ProcessorTime;

/// Work and rest alternate within this time: as often as a control loop of 100 Hz does.
const PERIOD: Duration = Duration::from_millis(10);

/// What each thread goes through again and again: about as much as the second-level cache of a core
/// holds, so that whoever runs next finds little of its own there.
const WORKING_SET_BYTES: usize = 1 << 20;

/// Of x86-64 and ARM64 processors.
const CACHE_LINE_BYTES: usize = 64;

/// Until threads have started and taken their share: a few periods.
const SETTLING: Duration = Duration::from_millis(100);

/// What the process that makes the load is asked to do.
#[derive(Debug, Args)]
pub struct LoadArguments {
    /// Share of each processor's time
    #[arg(long, value_parser = clap::value_parser!(u8).range(0..=100))]
    percent: u8,
}

/// A load that lasts until it is dropped, or this process ends, however it does.
#[derive(Debug)]
pub struct Load {
    process: Child,
    since: ProcessorTime,
}

impl Load {
    /// Starts a load of so many percent of each processor's time, and waits until it is there. To be
    /// called on a thread that lives as long as the load: with it the load ends.
    ///
    /// # Errors
    /// If the process cannot be started, or `/proc/stat` not be read.
    pub fn start(percent: u8) -> io::Result<Self> {
        let process = Command::new(std::env::current_exe()?)
            .args(["bench", "load", "--percent", &percent.to_string()])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()?;
        std::thread::sleep(SETTLING);
        Ok(Self {
            process,
            since: ProcessorTime::now()?,
        })
    }

    /// Percentage of all processors' time that was used since the load began, or since this was
    /// asked last, by anybody: the load itself, what is measured, everything else on the machine.
    ///
    /// # Errors
    /// If `/proc/stat` cannot be read.
    pub fn achieved_percent(&mut self) -> io::Result<f64> {
        let now = ProcessorTime::now()?;
        let since = std::mem::replace(&mut self.since, now);
        Ok(now.busy_percent_since(since))
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        // It has no other end; if it has ended already both fail, which is as well.
        let _ended_already = self.process.kill();
        let _ended_already = self.process.wait();
    }
}

/// Makes the load, in the process that was started for it, until that is killed.
pub fn run(arguments: &LoadArguments) -> ExitCode {
    if let Err(error) = end_with_parent() {
        eprintln!("steadfast bench load: it would outlive its parent: {error}");
        return ExitCode::FAILURE;
    }
    let work = PERIOD * u32::from(arguments.percent) / 100;
    let processors = processors();
    let count = u32::try_from(processors.len().max(1)).unwrap_or(1);
    std::thread::scope(|scope| {
        for (index, processor) in (0..count).zip(processors) {
            // They do not all work at the same time, as programs do not.
            let ahead = PERIOD * index / count;
            scope.spawn(move || keep_busy(processor, work, ahead));
        }
    });
    ExitCode::SUCCESS
}

/// The processors that this process may use.
fn processors() -> Vec<usize> {
    let permitted = sched_getaffinity(None).unwrap_or_default();
    let processors = 0..CpuSet::MAX_CPU;
    processors.filter(|it| permitted.is_set(*it)).collect()
}

fn keep_busy(processor: usize, work: Duration, ahead: Duration) {
    let mut only = CpuSet::new();
    only.set(processor);
    // Without a place of its own the scheduler spreads the threads, which is nearly as good.
    let _spread = sched_setaffinity(None, &only);
    let mut memory = vec![0_u8; WORKING_SET_BYTES];
    let mut begin = Instant::now() + ahead;
    loop {
        std::thread::sleep(begin.saturating_duration_since(Instant::now()));
        let start = Instant::now();
        while start.elapsed() < work {
            for line in memory.chunks_mut(CACHE_LINE_BYTES) {
                line[0] = line[0].wrapping_add(1);
            }
            std::hint::black_box(&mut memory);
        }
        // Time that was taken by others is not made up for.
        begin = (begin + PERIOD).max(Instant::now());
    }
}
