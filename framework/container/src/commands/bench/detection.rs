//! `steadfast bench detection`: how good the process-model detector is.
//!
//! The simulated robot drives from goal to goal, its left motor driver loses power at some time, and
//! each decision rule looks for it with a range of thresholds; on other drives, without a fault, the
//! same rules give their false alarms. The same drive without the fault says what physics allows:
//! until the encoder counts of the two differ, the data are the same, and no detector can know.

mod driving;
mod picture;
mod report;
mod series;
mod study;
mod workers;

use std::io::{self, IsTerminal as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use super::Format;
use system_profile::load_process_model;

use crate::commands::problems;
use study::{Extent, Study};

/// What the study is asked to do.
#[derive(Debug, Args)]
pub struct DetectionArguments {
    /// Drives with a fault, one for each seed
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    seeds: u32,
    /// Hours of robot time without a fault
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    hours: u32,
    /// The reference model, from motor command to wheel speeds
    #[arg(
        long,
        value_name = "FILE",
        default_value = "profiles/models/dc_motor.xml"
    )]
    model: PathBuf,
    /// Main board and motion board run in step, as in simulated time, not as it happens
    #[arg(long)]
    in_step: bool,
    /// Draw the result to this file (SVG)
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Runs the study. The exit code is 1 if the model has problems, 2 if a file cannot be written or
/// the simulation does not run.
pub fn run(arguments: &DetectionArguments) -> ExitCode {
    let outcome = load_process_model(&arguments.model);
    let colours = io::stderr().is_terminal();
    eprint!("{}", problems::render(&outcome.problems, colours));
    let Some(model) = outcome.model else {
        return ExitCode::from(1);
    };
    let extent = Extent {
        seeds: arguments.seeds,
        hours: arguments.hours,
        in_step: arguments.in_step,
    };
    match Study::run(&model, extent).and_then(|study| write(&study, arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("steadfast bench detection: {error}");
            ExitCode::from(2)
        }
    }
}

fn write(study: &Study, arguments: &DetectionArguments) -> io::Result<()> {
    if let Some(path) = &arguments.picture {
        let named =
            |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        std::fs::write(path, picture::draw(study)).map_err(named)?;
    }
    let mut output = io::stdout().lock();
    match arguments.format {
        Format::Text => report::write_text(&mut output, study),
        Format::Json => report::write_json(&mut output, study),
    }
}
