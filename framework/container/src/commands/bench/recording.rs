//! `steadfast bench recording`: what recording every port costs, and what it holds when data come a
//! hundred times as fast.
//!
//! An application is run by `steadfast run` in real time in processes of its own, in turns without
//! and with `--record`; the processor time of its threads is taken from outside. That of the
//! simulated world does not count: a real robot has none. Then the data of that very recording go
//! through a recorder at a hundred times their rate.

mod flood;
mod report;
mod rounds;

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::Format;
use super::machine::Machine;
use flood::Flood;
use rounds::Round;

/// What the study is asked to do.
#[derive(Debug, Args)]
pub struct RecordingArguments {
    /// The application that is recorded
    #[arg(
        value_name = "APPLICATION.xml",
        default_value = "profiles/applications/target_following.xml"
    )]
    application: PathBuf,
    /// One short round, to see that it works; the figures mean little
    #[arg(long)]
    quick: bool,
    /// Also look for component libraries in this folder; may be given several times
    #[arg(long = "library-path", value_name = "FOLDER")]
    library_path: Vec<PathBuf>,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// How much is measured.
#[derive(Debug, Clone, Copy)]
struct Extent {
    /// Pairs of runs.
    rounds: usize,
    /// Of which each is measured for so long. The reference robot reaches its target after half a
    /// minute.
    measured: Duration,
    /// For so long data come a hundred times as fast.
    flood: Duration,
}

/// What was measured.
#[derive(Debug, Serialize)]
struct Study {
    machine: Machine,
    rounds: Vec<Round>,
    /// How much more processor time recording takes, in percent: the median of all rounds.
    cost_percent: f64,
    flood: Flood,
}

/// Runs the study. The exit code is 2 if a run fails or a file cannot be written.
pub fn run(arguments: &RecordingArguments) -> ExitCode {
    let extent = match arguments.quick {
        true => Extent {
            rounds: 1,
            measured: Duration::from_secs(2),
            flood: Duration::from_secs(1),
        },
        false => Extent {
            rounds: 5,
            measured: Duration::from_secs(20),
            flood: Duration::from_secs(10),
        },
    };
    match study(arguments, extent).and_then(|study| write(&study, arguments.format)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("steadfast bench recording: {error}");
            ExitCode::from(2)
        }
    }
}

fn study(arguments: &RecordingArguments, extent: Extent) -> io::Result<Study> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("drive.mcap");
    let progress = progress(extent.rounds);
    let mut measured = Vec::new();
    for number in 0..extent.rounds {
        measured.push(rounds::measure(arguments, &file, number, extent.measured)?);
        progress.inc(1);
    }
    progress.set_message("a hundred times the data");
    let flood = flood::run(arguments, &file, folder.path(), extent.flood)?;
    progress.finish_and_clear();
    let mut costs: Vec<f64> = measured.iter().map(Round::cost_percent).collect();
    costs.sort_by(f64::total_cmp);
    Ok(Study {
        machine: Machine::here(),
        cost_percent: costs[costs.len() / 2],
        rounds: measured,
        flood,
    })
}

/// On standard error, and only if that is a terminal.
fn progress(rounds: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}");
    let progress = ProgressBar::new(rounds as u64);
    match style {
        Ok(style) => progress.with_style(style),
        Err(_malformed) => progress,
    }
}

fn write(study: &Study, format: Format) -> io::Result<()> {
    let mut output = io::stdout().lock();
    match format {
        Format::Text => report::write(&mut output, study),
        Format::Json => {
            serde_json::to_writer_pretty(&mut output, study)?;
            io::Write::write_all(&mut output, b"\n")
        }
    }
}
