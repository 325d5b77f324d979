//! `steadfast bench`: how good Steadfast is at what it does, measured here and now.

mod detection;

use std::process::ExitCode;

use clap::{Args, Subcommand};

/// What `steadfast bench` is asked to do.
#[derive(Debug, Args)]
pub struct BenchArguments {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    /// Motor driver fault: detection delay against false alarms for each decision rule.
    Detection(detection::DetectionArguments),
}

/// Runs a study and writes its result to standard output.
pub fn run(arguments: &BenchArguments) -> ExitCode {
    match &arguments.study {
        Study::Detection(arguments) => detection::run(arguments),
    }
}
