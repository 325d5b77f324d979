//! One batch of faults, in a process of its own: brings the application up, watches it, and makes
//! rows of what is on record.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;
use container::assembly::LibraryOptions;
use container::library::LibrarySearch;
use container::recording::RecordingOptions;
use container::system::{Application, ClockKind, RunOptions, StateOptions, System};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use system_profile::{LoadOptions, Problem, load_application, load_injections, load_rules};

use super::application::{APPLICATION, Batch, INJECTIONS, RULES, relay_name};
use super::evaluation::{Row, evaluate};
use super::killer::kill_in_turn;
use super::real_time::{ask_for_real_time, lock_memory};
use super::record::Record;
use super::scenario::{Fault, Handling};
use super::witness::{Seen, watch};
use crate::commands::bench::offspring::{end_with_parent, end_within};
use crate::commands::problems;
use crate::commands::run::library_folders;

/// Many times what a batch takes.
const LIMIT: Duration = Duration::from_secs(300);

/// What the process that measures a batch is asked to do.
#[derive(Debug, Args)]
pub struct BatchArguments {
    /// The batch, as JSON
    batch: String,
    /// A folder for the application's files
    #[arg(long)]
    folder: PathBuf,
    /// Also look for the component under test in this folder
    #[arg(long = "library-path", value_name = "FOLDER")]
    library_path: Vec<PathBuf>,
}

/// Measures and prints the rows as JSON.
pub fn run(arguments: &BatchArguments) -> ExitCode {
    let measured = measure(arguments).and_then(|rows| {
        let text = serde_json::to_string(&rows)?;
        writeln!(io::stdout(), "{text}")
    });
    match measured {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("steadfast bench batch: {error}");
            ExitCode::from(2)
        }
    }
}

fn measure(arguments: &BatchArguments) -> io::Result<Vec<Row>> {
    end_with_parent()?;
    end_within(LIMIT)?;
    let batch: Batch = serde_json::from_str(&arguments.batch)?;
    let folder = &arguments.folder;
    batch.write(folder)?;
    let application = load(folder)?;
    allow_many_files();
    let _without = lock_memory();
    let events = folder.join("events.jsonl");
    let options = RunOptions {
        clock: ClockKind::Real,
        duration: None,
        seed: 1,
        events: Some(events.clone()),
        echo: None,
        libraries: LibraryOptions {
            search: LibrarySearch::new(library_folders(&arguments.library_path)),
            executable: std::env::current_exe().ok(),
        },
        state: StateOptions::default(),
        score: None,
        recording: RecordingOptions::default(),
        supervised: None,
        network: None,
    };
    let system = System::start(vec![application], Vec::new(), options).map_err(io::Error::other)?;
    // Above the load, below everything that is measured. Not before the system's threads are there,
    // which would take it over.
    let _without = ask_for_real_time(1);
    let names: Vec<String> = batch
        .relays()
        .map(|(number, _)| relay_name(number))
        .collect();
    let seen = observe(&system, &names, &batch);
    let (_summary, log_error) = system.stop("measured");
    if let Some(error) = log_error {
        return Err(error);
    }
    let record = Record::read(&std::fs::read_to_string(events)?)?;
    Ok(evaluate(&batch, &seen, &record))
}

/// Watches all faults of a batch, and makes those that come from outside.
fn observe(system: &System, names: &[String], batch: &Batch) -> Vec<Seen> {
    let (recoveries, stops) = expected(batch);
    if batch.group.fault != Fault::HostKilled {
        return watch(system, names, recoveries, stops);
    }
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let killer = scope.spawn(|| kill_in_turn(system, names, &done));
        let mut seen = watch(system, names, recoveries, stops);
        done.store(true, Ordering::Release);
        let killed_ns = killer.join().unwrap_or_default();
        for (seen, killed_ns) in seen.iter_mut().zip(killed_ns) {
            seen.misbehaved_ns = killed_ns;
        }
        seen
    })
}

/// How often each component recovers, and how many emergency stops there are in all.
fn expected(batch: &Batch) -> (usize, usize) {
    let faults = batch.faults as usize;
    match (
        batch.group.handlings.contains(&Handling::EmergencyStop),
        batch.group.fault,
    ) {
        (false, _) => (faults, 0),
        // It runs on.
        (true, Fault::OutOfRange) => (0, faults),
        // The first one is within the budget.
        (true, _) => (0, faults.saturating_sub(1)),
    }
}

/// Reads the application as `steadfast run` does.
pub(super) fn load(folder: &Path) -> io::Result<Application> {
    let options = LoadOptions::default();
    let outcome = load_application(&folder.join(APPLICATION), &options);
    let specification = sound(outcome.specification, &outcome.problems)?;
    let outcome = load_rules(&specification, &[folder.join(RULES)], &options);
    let rules = sound(outcome.rules, &outcome.problems)?;
    let outcome = load_injections(&specification, &folder.join(INJECTIONS));
    let injections = sound(outcome.injections, &outcome.problems)?;
    Ok(Application {
        specification,
        rules,
        models: Vec::new(),
        plans: Vec::new(),
        injections,
        task: None,
    })
}

fn sound<T>(read: Option<T>, found: &[Problem]) -> io::Result<T> {
    read.ok_or_else(|| io::Error::other(problems::render(found, false)))
}

/// Each copy of a library keeps a file open, and many are used up here.
fn allow_many_files() {
    let limit = getrlimit(Resource::Nofile);
    let all = Rlimit {
        current: limit.maximum,
        maximum: limit.maximum,
    };
    // Where it is refused, which is not known of any system, loads fail later and say so.
    let _said_later = setrlimit(Resource::Nofile, all);
}
