//! `steadfast bench recovery`: how long it takes from a fault until its component works again.
//!
//! Each row is measured on a running application whose rules are XML, by way of the whole fault
//! manager, at several loads. Beside the rows stands the floor of the same machine in the same run:
//! what a trap, a wake-up of another process, a signal and a load of a library take by themselves.
//! Everything that is measured runs in a process of its own, so that what one leaves behind costs
//! the next nothing.

mod application;
mod batch;
mod children;
mod evaluation;
mod floor;
mod killer;
mod mortal;
mod picture;
mod plan;
mod progress;
mod real_time;
mod record;
mod report;
mod results;
mod scenario;
mod signalled;
mod witness;

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::Format;
use super::load::Load;
use super::machine::Machine;
use application::Batch;
use children::{measure_batch, measure_floor};
use plan::batches;
use progress::Progress;
use results::{FloorRow, LoadRow, RecoveryRow, Results};
use scenario::{Group, Tier, groups};

pub use batch::{BatchArguments, run as run_batch};
pub use floor::{FloorArguments, run as run_floor, run_partner};
pub use mortal::run_mortal;

/// What the study is asked to do.
#[derive(Debug, Args)]
pub struct RecoveryArguments {
    /// Loads of all processors, in percent, made by a process of its own at normal priority
    #[arg(
        long,
        value_name = "PERCENT",
        value_delimiter = ',',
        default_values_t = [10, 40, 60, 80],
        value_parser = clap::value_parser!(u8).range(0..=95)
    )]
    load: Vec<u8>,
    /// Faults of each row
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=5_000))]
    n: u32,
    /// Faults of each row of the tier `process`
    #[arg(
        long,
        default_value_t = 200,
        value_parser = clap::value_parser!(u32).range(1..=5_000)
    )]
    process_n: u32,
    /// Also the rows that differ from another one in nothing but detection
    #[arg(long)]
    all: bool,
    /// A first impression within seconds: few faults, one load
    #[arg(long, conflicts_with_all = ["n", "process_n", "load"])]
    quick: bool,
    /// Draw the result to this file (SVG)
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Also look for the component under test in this folder; may be given several times
    #[arg(long = "library-path", value_name = "FOLDER")]
    library_path: Vec<PathBuf>,
}

/// Of a first impression.
const QUICK_N: u32 = 10;
const QUICK_LOAD_PERCENT: u8 = 10;

/// Of each operation of the floor: enough for a 99th percentile.
const FLOOR_N: u32 = 300;

/// Runs the study. The exit code is 2 if something cannot be started, measured, read or written; what
/// was measured is written all the same.
pub fn run(arguments: &RecoveryArguments) -> ExitCode {
    let failures = measure(arguments).and_then(|results| {
        write(&results, arguments)?;
        Ok(results.failures)
    });
    let failures = failures.unwrap_or_else(|error| vec![error.to_string()]);
    for failure in &failures {
        eprintln!("steadfast bench recovery: {failure}");
    }
    match failures.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::from(2),
    }
}

fn measure(arguments: &RecoveryArguments) -> io::Result<Results> {
    let (loads, n, process_n) = match arguments.quick {
        true => (vec![QUICK_LOAD_PERCENT], QUICK_N, QUICK_N),
        false => (arguments.load.clone(), arguments.n, arguments.process_n),
    };
    let n_of = |group: &Group| match group.tier {
        Tier::Guarded => n,
        Tier::Process => process_n,
    };
    let machine = Machine::here();
    if !machine.real_time {
        eprintln!(
            "steadfast bench recovery: real-time scheduling is NOT permitted: executors share the \
             processors with the load, and figures under load tell of the scheduler\n  help: run it \
             as root, or with CAP_SYS_NICE"
        );
    }
    let work_beside = |load_percent| -> Vec<(Group, Vec<Batch>)> {
        let groups = groups(arguments.all).into_iter();
        let planned = groups.map(|group| {
            let batches = batches(&group, n_of(&group), load_percent);
            (group, batches)
        });
        planned.collect()
    };
    let per_load: usize = work_beside(0)
        .iter()
        .map(|(_, batches)| batches.len())
        .sum();
    let progress = Progress::new(loads.len() * (per_load + 1));
    let mut results = Results::of(machine);
    for load_percent in loads {
        let mut load = Load::start(load_percent)?;
        progress.show(&format!("load {load_percent} %: floor"));
        let floor = measure_floor(&arguments.library_path, n.min(FLOOR_N))?;
        progress.advance();
        let of_load = |operation| FloorRow::new(operation, load_percent);
        results.floor.extend(floor.into_iter().filter_map(of_load));
        for (group, batches) in &work_beside(load_percent) {
            let mut measured = Vec::new();
            for batch in batches {
                let (tier, fault) = (group.tier.name(), group.fault.name());
                progress.show(&format!("load {load_percent} %: {tier}, {fault}"));
                match measure_batch(&arguments.library_path, batch) {
                    Ok(rows) => measured.extend(rows),
                    Err(error) => results.failures.push(error.to_string()),
                }
                progress.advance();
            }
            let rows = RecoveryRow::of_group(group, load_percent, &measured);
            results.rows.extend(rows);
        }
        results.loads.push(LoadRow {
            load_percent,
            achieved_percent: load.achieved_percent()?,
        });
    }
    Ok(results)
}

fn write(results: &Results, arguments: &RecoveryArguments) -> io::Result<()> {
    if let Some(path) = &arguments.picture {
        let named =
            |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        std::fs::write(path, picture::draw(results)).map_err(named)?;
    }
    let mut output = io::stdout().lock();
    match arguments.format {
        Format::Text => report::write_text(&mut output, results),
        Format::Json => report::write_json(&mut output, results),
    }
}
