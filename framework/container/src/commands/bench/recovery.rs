//! `steadfast bench recovery`: how long it takes from a fault until its component works again.
//!
//! Each row is measured on a running application whose rules are XML, by way of the whole fault
//! manager, at several loads. Beside the rows stands the floor of the same machine in the same run:
//! what a trap, a wake-up of another process, a signal and a load of a library take by themselves.
//! Everything that is measured runs in a process of its own, so that what one leaves behind costs
//! the next nothing.

mod children;
mod floor;
mod real_time;
mod report;

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use super::load::Load;
use super::machine::Machine;
use children::measure_floor;
use report::{FloorRow, LoadRow, Results};

pub use floor::{FloorArguments, run as run_floor};

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
    /// A first impression within seconds: few faults, one load
    #[arg(long, conflicts_with_all = ["n", "load"])]
    quick: bool,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Also look for the component under test in this folder; may be given several times
    #[arg(long = "library-path", value_name = "FOLDER")]
    library_path: Vec<PathBuf>,
}

/// How the result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: a table
    Text,
    /// For programs: one JSON object
    Json,
}

/// Of a first impression.
const QUICK_N: u32 = 20;
const QUICK_LOAD_PERCENT: u8 = 10;

/// Of each operation of the floor: enough for a 99th percentile.
const FLOOR_N: u32 = 500;

/// Runs the study. The exit code is 2 if something cannot be started, read or written.
pub fn run(arguments: &RecoveryArguments) -> ExitCode {
    match measure(arguments).and_then(|results| write(&results, arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("steadfast bench recovery: {error}");
            ExitCode::from(2)
        }
    }
}

fn measure(arguments: &RecoveryArguments) -> io::Result<Results> {
    let (loads, n) = match arguments.quick {
        true => (vec![QUICK_LOAD_PERCENT], QUICK_N),
        false => (arguments.load.clone(), arguments.n),
    };
    let mut results = Results::of(Machine::here());
    for load_percent in loads {
        let mut load = Load::start(load_percent)?;
        let floor = measure_floor(&arguments.library_path, n.min(FLOOR_N))?;
        let of_load = |operation| FloorRow::new(operation, load_percent);
        results.floor.extend(floor.into_iter().filter_map(of_load));
        results.loads.push(LoadRow {
            load_percent,
            achieved_percent: load.achieved_percent()?,
        });
    }
    Ok(results)
}

fn write(results: &Results, arguments: &RecoveryArguments) -> io::Result<()> {
    let mut output = io::stdout().lock();
    match arguments.format {
        Format::Text => report::write_text(&mut output, results),
        Format::Json => report::write_json(&mut output, results),
    }
}
