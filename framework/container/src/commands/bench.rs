//! `steadfast bench`: how good Steadfast is at what it does, measured here and now.

mod detection;
mod drawing;
mod load;
mod machine;
mod offspring;
mod overhead;
pub(in crate::commands) mod percentiles;
mod processor_time;
mod recording;
mod recovery;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Subcommand, ValueEnum};

/// What `steadfast bench` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::BENCH)]
pub struct BenchArguments {
    #[command(subcommand)]
    study: Study,
}

#[derive(Debug, Subcommand)]
enum Study {
    /// Motor driver fault: detection delay against false alarms for each decision rule.
    Detection(detection::DetectionArguments),
    /// What fault tolerance costs while nothing fails: time, memory, start.
    Overhead(overhead::OverheadArguments),
    /// What recording costs, and what it holds of a hundred times the data.
    Recording(recording::RecordingArguments),
    /// How long it takes from a fault until its component works again, under load.
    Recovery(recovery::RecoveryArguments),
    /// Keep all processors busy for a share of their time, until killed.
    #[command(hide = true)]
    Load(load::LoadArguments),
    /// Measure the floor of `bench recovery` in this process.
    #[command(hide = true)]
    Floor(recovery::FloorArguments),
    /// Answer wake-ups of the process that measures the floor, until killed.
    #[command(hide = true)]
    WakePartner {
        /// Its shared memory.
        memory: PathBuf,
    },
    /// Wait to be killed by the process that measures the floor.
    #[command(hide = true)]
    Mortal {
        /// Its shared memory.
        memory: PathBuf,
    },
    /// Measure some rows of `bench recovery` in this process.
    #[command(hide = true)]
    Batch(recovery::BatchArguments),
}

/// How a result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: tables
    Text,
    /// For programs: one JSON object
    Json,
}

/// Runs a study and writes its result to standard output.
pub fn run(arguments: &BenchArguments) -> ExitCode {
    match &arguments.study {
        Study::Detection(arguments) => detection::run(arguments),
        Study::Overhead(arguments) => overhead::run(arguments),
        Study::Recording(arguments) => recording::run(arguments),
        Study::Recovery(arguments) => recovery::run(arguments),
        Study::Load(arguments) => load::run(arguments),
        Study::Floor(arguments) => recovery::run_floor(arguments),
        Study::WakePartner { memory } => recovery::run_partner(memory),
        Study::Mortal { memory } => recovery::run_mortal(memory),
        Study::Batch(arguments) => recovery::run_batch(arguments),
    }
}
