//! `steadfast bench overhead`: what fault tolerance costs while nothing fails.
//!
//! Chains of components are written as XML and run by `steadfast run` in processes of their own:
//! once without rules, once with all kinds of them on every component, in each isolation tier. A
//! stopwatch at either end of the chain takes the times, so nothing of the container knows that it
//! is measured. Memory and start are looked at from outside.

mod application;
mod extent;
mod memory;
mod picture;
mod report;
mod rules;
mod study;
mod times;
mod trial;

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::Format;
use super::machine::Machine;
use extent::Extent;
use study::Study;

/// What the study is asked to do.
#[derive(Debug, Args)]
pub struct OverheadArguments {
    /// A few short runs, to see that it works; the figures mean little
    #[arg(long)]
    quick: bool,
    /// Draw the result to this file (SVG)
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Runs the study. The exit code is 2 if a run fails or a file cannot be written.
pub fn run(arguments: &OverheadArguments) -> ExitCode {
    let extent = match arguments.quick {
        true => Extent::quick(),
        false => Extent::usual(),
    };
    let progress = progress();
    let study = Study::run(&extent, &progress);
    progress.finish_and_clear();
    match study.and_then(|study| write(&study, arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("steadfast bench overhead: {error}");
            ExitCode::from(2)
        }
    }
}

/// On standard error, and only if that is a terminal.
fn progress() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}");
    let progress = ProgressBar::new(0);
    match style {
        Ok(style) => progress.with_style(style),
        Err(_malformed) => progress,
    }
}

fn write(study: &Study, arguments: &OverheadArguments) -> io::Result<()> {
    if let Some(path) = &arguments.picture {
        let named =
            |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        std::fs::write(path, picture::draw(study)).map_err(named)?;
    }
    let machine = Machine::here();
    let mut output = io::stdout().lock();
    match arguments.format {
        Format::Text => report::write_text(&mut output, study, &machine),
        Format::Json => report::write_json(&mut output, study, &machine),
    }
}
