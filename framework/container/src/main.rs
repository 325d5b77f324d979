//! The `steadfast` command.
#![forbid(unsafe_code)]

mod commands;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory as _, Parser, Subcommand};

use commands::adapt::{self, AdaptArguments};
use commands::bench::{self, BenchArguments};
use commands::check::{self, CheckArguments};
use commands::completions::{self, CompletionsArguments};
use commands::component::{self, ComponentArguments};
use commands::explain::{self, ExplainArguments};
use commands::fault::{self, FaultArguments};
use commands::graph::{self, GraphArguments};
use commands::man::{self, ManArguments};
use commands::new::{self, NewArguments};
use commands::package::{self, PackageArguments};
use commands::replay::{self, ReplayArguments};
use commands::report::{self, ReportArguments};
use commands::run::{self, RunArguments};
use commands::schema::{self, SchemaArguments};
use commands::status::{self, StatusArguments};
use commands::top::{self, TopArguments};
use commands::tree::{self, TreeArguments};
use commands::world::{self, WorldArguments};

/// Fault tolerance for component-based robots, declared in XML.
///
/// A robot is assembled from components in shared libraries, as XML profiles say. Each runs behind a
/// guard: when one crashes or hangs, that one is out, and the rest goes on. What then happens to it
/// is said in XML rules: it is reset with its memory restored, replaced by another one, stopped with
/// what depends on it, or the robot makes an emergency stop.
#[derive(Debug, Parser)]
#[command(name = "steadfast", version, after_long_help = commands::manual::STEADFAST)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Check profiles and rules: every problem with its place and what to do about it.
    ///
    /// Reads profiles of all kinds (component, application, composite, service type, data type,
    /// system, world), reference models, tasks, fault rules and injections, in the encoding that they
    /// declare, and everything they refer to. No library is loaded.
    Check(CheckArguments),
    /// Run one application, or several in one container.
    ///
    /// Reads all files, loads and compares the libraries, brings the components up in order and runs
    /// them until --for has passed, the robot has reached its target, or Ctrl-C, which stops
    /// everything in order; a second Ctrl-C ends the process at once. Without rules a component that
    /// fails is reset, at most three times in a minute.
    Run(Box<RunArguments>),
    /// Play a recording again: to a component, or to the rules alone.
    Replay(ReplayArguments),
    /// Show how a running application is.
    Status(StatusArguments),
    /// Watch a running application on the terminal, and act on it by keys.
    Top(TopArguments),
    /// List, show, reset, replace and stop components of a running application.
    Component(ComponentArguments),
    /// Explain what the rules do, and what would come of a fault, without a robot.
    Explain(ExplainArguments),
    /// Draw who runs where and what goes from whom to whom.
    Graph(GraphArguments),
    /// Tell what happened in a run as one HTML page, which needs no network.
    ///
    /// In one paragraph, with the drive from above, the states of all components over time, and for
    /// each fault what was seen, why it was judged so, what was done and how long that took. With a
    /// recording the signals around each fault are plotted.
    Report(ReportArguments),
    /// List, show, clear and inject faults of a running application.
    ///
    /// Talks to `steadfast run` over a socket that only its user may open.
    Fault(FaultArguments),
    /// Show what self-adaptation would decide, without a robot.
    ///
    /// A task may be done by several components on several robots. This finds the ways to do it, judges
    /// each by its errors and by the resources that it leaves, and says which one would be chosen and
    /// why not the others.
    Adapt(AdaptArguments),
    /// Sign, check, fetch and unpack components that go from robot to robot.
    ///
    /// A package has a component's library and profile. Nothing of one is unpacked unless a key that
    /// is trusted has signed it, for this architecture and this version of the ABI.
    Package(PackageArguments),
    /// Write a project that builds, runs and passes its own test: a component or an application.
    ///
    /// The project lies in a new folder of its name. It refers to the SDK of a clone of Steadfast,
    /// which is looked for upward from this executable and from the current folder.
    New(NewArguments),
    /// Print XML schemas, by which editors complete, check and explain profiles and rules.
    ///
    /// Each schema is one XSD 1.0 document with the documentation of every element and attribute in
    /// it. What XSD cannot say (names in other files, bounds that depend on each other) is known to
    /// `steadfast check` alone.
    Schema(SchemaArguments),
    /// Check, show and try out behaviour trees of BehaviorTree.CPP and Nav2.
    ///
    /// Reads files of versions 3 and 4 with all that they include. Trees are executed in simulated
    /// time with stubs for leaves: nodes that only answer.
    Tree(TreeArguments),
    /// Measure how good Steadfast is at what it does.
    ///
    /// Each study prints a table; --format json has all figures, --picture a drawing.
    Bench(BenchArguments),
    /// Print what a shell needs to complete commands and options.
    Completions(CompletionsArguments),
    /// Print or write manual pages.
    Man(ManArguments),
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
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(told) => {
            // If nobody reads the text the exit code still tells.
            let _unread = told.print();
            let is_mistake = told.use_stderr();
            return ExitCode::from(if is_mistake { commands::USAGE } else { 0 });
        }
    };
    match arguments.command {
        Command::Check(arguments) => check::run(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Package(arguments) => package::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Status(arguments) => status::run(&arguments),
        Command::Top(arguments) => top::run(&arguments),
        Command::Component(arguments) => component::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Graph(arguments) => graph::run(&arguments),
        Command::Report(arguments) => report::run(&arguments),
        Command::Fault(arguments) => fault::run(&arguments),
        Command::Adapt(arguments) => adapt::run(&arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Tree(arguments) => tree::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments, Arguments::command()),
        Command::Man(arguments) => man::run(&arguments, Arguments::command()),
        Command::Host => container::host::host_main(),
        Command::World(arguments) => world::run(&arguments),
        Command::ProbeLibrary { path } => container::library::probe_main(&path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Words of a line as a shell makes them of single quotes and blanks.
    fn words(line: &str) -> Vec<String> {
        let mut words = Vec::new();
        for (number, part) in line.split('\'').enumerate() {
            match number % 2 {
                0 => words.extend(part.split_whitespace().map(str::to_owned)),
                _ => words.push(part.to_owned()),
            }
        }
        words
    }

    #[test]
    fn the_command_line_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_command_has_examples_that_work_and_exit_codes() {
        let command = Arguments::command();
        let visible = command.get_subcommands().filter(|it| !it.is_hide_set());
        for command in visible.chain([&command]) {
            let name = command.get_name();
            let manual = command.get_after_long_help().map(ToString::to_string);
            let manual = manual.unwrap_or_else(|| panic!("{name} has no manual"));
            assert!(manual.contains("Exit codes"), "{name}");
            let lines = manual.lines().map(str::trim);
            let examples: Vec<&str> = lines.filter(|it| it.starts_with("steadfast ")).collect();
            assert!(!examples.is_empty(), "{name}");
            for example in examples {
                // What stands behind two blanks says what the example does; what stands behind a
                // sign is the shell's.
                let line = example.split("  ").next().unwrap_or_default();
                let line = line.split(" > ").next().unwrap_or_default();
                let parsed = Arguments::try_parse_from(words(line));
                assert!(parsed.is_ok(), "{example}: {:?}", parsed.err());
            }
        }
    }
}
