//! The `steadfast` command.
#![forbid(unsafe_code)]

mod commands;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use commands::bench::{self, BenchArguments};
use commands::check::{self, CheckArguments};
use commands::explain::{self, ExplainArguments};
use commands::fault::{self, FaultArguments};
use commands::graph::{self, GraphArguments};
use commands::run::{self, RunArguments};
use commands::world::{self, WorldArguments};

/// Fault tolerance for component-based robots, declared in XML.
#[derive(Debug, Parser)]
#[command(name = "steadfast", version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Check profiles: every problem with its place and what to do about it.
    Check(CheckArguments),
    /// Run one application, or several in one container.
    Run(Box<RunArguments>),
    /// Explain what the rules do, and what would come of a fault, without a robot.
    Explain(ExplainArguments),
    /// Draw who runs where and what goes from whom to whom.
    Graph(GraphArguments),
    /// List, show, clear and inject faults of a running application.
    Fault(FaultArguments),
    /// Measure how good Steadfast is at what it does.
    Bench(BenchArguments),
    /// Run components for a container, as it says on the standard input.
    #[command(hide = true)]
    Host,
    /// Be the simulated world of a supervised run.
    #[command(hide = true)]
    World(WorldArguments),
    /// Load a library and say by the exit code whether that works.
    #[command(hide = true)]
    ProbeLibrary {
        /// The library.
        path: PathBuf,
    },
}

fn main() -> ExitCode {
    match Arguments::parse().command {
        Command::Check(arguments) => check::run(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Graph(arguments) => graph::run(&arguments),
        Command::Fault(arguments) => fault::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Host => container::host::host_main(),
        Command::World(arguments) => world::run(&arguments),
        Command::ProbeLibrary { path } => container::library::probe_main(&path),
    }
}
