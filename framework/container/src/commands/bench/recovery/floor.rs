//! The floor: what the operations take by themselves that a recovery is made of, one at a time and
//! seldom, so that caches are as cold as they are when a fault happens.

use std::io;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Args;
use container::guard::BareTrap;
use container::library::{LibrarySearch, LoadedLibrary};
use serde::{Deserialize, Serialize};

use super::real_time::{ask_for_real_time, lock_memory};
use crate::commands::run::library_folders;

/// From one operation to the next; in between others run, and each comes every 4 ms or so.
const PAUSE: Duration = Duration::from_millis(1);

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
    let search = LibrarySearch::new(library_folders(&arguments.library_path));
    let library = search.find(LIBRARY).map_err(io::Error::other)?;
    let _without = lock_memory();
    let _without = ask_for_real_time();
    let mut traps = Traps::new()?;
    let mut operations: [(&str, Timed); 2] = [
        ("trap", Box::new(move || traps.time())),
        ("dlopen", Box::new(move || time_load(&library))),
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
