//! The floor: what the operations take by themselves that a recovery is made of, one at a time and
//! seldom, so that caches are as cold as they are when a fault happens.

use std::io;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use clap::Args;
use container::bare_wake::BareWake;
use container::guard::BareTrap;
use container::library::{LibrarySearch, LoadedLibrary};
use serde::{Deserialize, Serialize};

use super::mortal::time_death;
use super::real_time::{PRIORITY, ask_for_real_time, lock_memory};
use super::signalled::Signalled;
use crate::commands::bench::offspring::{end_with_parent, end_within};
use crate::commands::run::library_folders;

/// From one operation to the next. In between others run, and each comes every 2 ms or so, about as
/// often as a fault does in an application under test.
const PAUSE: Duration = Duration::from_micros(400);

/// Many times what the floor takes.
const LIMIT: Duration = Duration::from_secs(300);

/// What is loaded: the component under test.
const LIBRARY: &str = "librelay.so";

/// What the process that measures the floor is asked to do.
#[derive(Debug, Args)]
pub struct FloorArguments {
    /// How often each operation is done
    #[arg(long)]
    n: u32,
    /// Also look for the component under test in this folder
    #[arg(long = "library-path", value_name = "FOLDER")]
    library_path: Vec<PathBuf>,
}

/// How long an operation took, each time.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Operation {
    /// What it is called in the report.
    pub(super) name: String,
    /// In nanoseconds, in the order of measurement.
    pub(super) samples_ns: Vec<u64>,
}

/// Does an operation once; how long it took, in nanoseconds.
type Timed = Box<dyn FnMut() -> io::Result<u64>>;

/// Measures, in the process that was started for it, and prints the operations as JSON.
pub fn run(arguments: &FloorArguments) -> ExitCode {
    let measured = measure(arguments).and_then(|operations| {
        let text = serde_json::to_string(&operations)?;
        writeln!(io::stdout(), "{text}")
    });
    match measured {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("steadfast bench floor: {error}");
            ExitCode::from(2)
        }
    }
}

fn measure(arguments: &FloorArguments) -> io::Result<Vec<Operation>> {
    end_with_parent()?;
    end_within(LIMIT)?;
    let search = LibrarySearch::new(library_folders(&arguments.library_path));
    let library = search.find(LIBRARY).map_err(io::Error::other)?;
    let _without = lock_memory();
    let _without = ask_for_real_time(PRIORITY);
    let mut traps = Traps::new()?;
    let signalled = Signalled::start()?;
    let partner = Partner::start()?;
    let mut operations: [(&str, Timed); 5] = [
        ("dlopen", Box::new(move || time_load(&library))),
        ("trap", Box::new(move || traps.time())),
        ("signal", Box::new(move || signalled.time())),
        ("process_wake", Box::new(move || partner.time())),
        ("death_notice", Box::new(time_death)),
    ];
    let mut samples: Vec<Vec<u64>> = vec![Vec::new(); operations.len()];
    for _ in 0..arguments.n {
        for ((_, operation), samples) in operations.iter_mut().zip(&mut samples) {
            std::thread::sleep(PAUSE);
            samples.push(operation()?);
        }
    }
    let named = operations.iter().zip(samples);
    Ok(named
        .map(|((name, _), samples_ns)| Operation {
            name: (*name).to_owned(),
            samples_ns,
        })
        .collect())
}

/// A trap through a coroutine and back, by the least of all handlers.
struct Traps {
    bare: Option<BareTrap>,
}

impl Traps {
    fn new() -> io::Result<Self> {
        let bare = Some(BareTrap::install()?);
        Ok(Self { bare })
    }

    fn time(&mut self) -> io::Result<u64> {
        let lost = || io::Error::other("a bare trap did not come back");
        let mut bare = self.bare.take().ok_or_else(lost)?;
        let start = Instant::now();
        let trapped = bare.round_trip();
        let took = nanoseconds(start.elapsed());
        if !trapped {
            return Err(lost());
        }
        self.bare = Some(bare.renewed());
        Ok(took)
    }
}

/// Another process, woken and waking back.
struct Partner {
    wake: BareWake,
    process: Child,
}

impl Partner {
    fn start() -> io::Result<Self> {
        let wake = BareWake::create()?;
        let process = Command::new(std::env::current_exe()?)
            .args(["bench", "wake-partner"])
            .arg(wake.path())
            .stdin(Stdio::null())
            .spawn()?;
        // Until it is there.
        wake.round_trip()?;
        Ok(Self { wake, process })
    }

    fn time(&self) -> io::Result<u64> {
        let start = Instant::now();
        self.wake.round_trip()?;
        Ok(nanoseconds(start.elapsed()))
    }
}

impl Drop for Partner {
    fn drop(&mut self) {
        // If it has ended already both fail, which is as well.
        let _ended_already = self.process.kill();
        let _ended_already = self.process.wait();
    }
}

/// Answers wake-ups, in the process that was started for it, until it is killed.
pub fn run_partner(path: &Path) -> ExitCode {
    let _without = ask_for_real_time(PRIORITY);
    let answered = end_with_parent().and_then(|()| BareWake::open(path)?.answer());
    match answered {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("steadfast bench wake-partner: {error}");
            ExitCode::from(2)
        }
    }
}

/// A fresh copy of a library: read, written to memory, sealed, loaded, looked at.
fn time_load(library: &Path) -> io::Result<u64> {
    let start = Instant::now();
    let loaded = LoadedLibrary::load(library).map_err(io::Error::other)?;
    let took = nanoseconds(start.elapsed());
    drop(loaded);
    Ok(took)
}

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
