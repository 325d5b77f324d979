//! `steadfast fault`: faults of a running application are listed, shown, cleared and injected.

mod text;

use std::process::ExitCode;

use clap::{Args, Subcommand};
use container::control::Request;
use container::control::protocol::Inject;

use super::operator::{Format, Target, conclude};

/// What `steadfast fault` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::FAULT)]
pub struct FaultArguments {
    #[command(subcommand)]
    command: FaultCommand,
    #[command(flatten)]
    target: Target,
    /// How the answer is written
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Debug, Subcommand)]
enum FaultCommand {
    /// List all faults, the oldest first
    List,
    /// Show everything that is known of a fault
    Show {
        /// Its number
        id: u64,
    },
    /// End a fault that has healed or is latched
    Clear {
        /// Its number
        #[arg(required_unless_present = "all")]
        id: Option<u64>,
        /// End all of them, and the emergency stop
        #[arg(long, conflicts_with = "id")]
        all: bool,
    },
    /// Make something go wrong: `<inject component="camera" fault="hang" at="2s"/>`
    Inject {
        /// The element, as in an injection file; times count from now
        element: String,
    },
}

/// Asks the running application and writes its answer.
pub fn run(arguments: &FaultArguments) -> ExitCode {
    let request = request(&arguments.command);
    let answer = arguments.target.ask(&request);
    conclude(answer, arguments.format, |content| {
        text::of(&request, content)
    })
}

fn request(command: &FaultCommand) -> Request {
    match command {
        FaultCommand::List => Request::FaultList,
        FaultCommand::Show { id } => Request::FaultShow { id: *id },
        FaultCommand::Clear { id, .. } => Request::FaultClear { id: *id },
        FaultCommand::Inject { element } => Request::FaultInject {
            inject: Inject::Element(element.clone()),
        },
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        fault: FaultArguments,
    }

    fn asked(line: &str) -> Option<Request> {
        let words = std::iter::once("fault").chain(line.split(' '));
        let line = Line::try_parse_from(words).ok()?;
        Some(request(&line.fault.command))
    }

    #[test]
    fn command_lines() {
        for (line, expected) in [
            ("list", Some(Request::FaultList)),
            (
                "list --application patrol --format json",
                Some(Request::FaultList),
            ),
            ("show 3", Some(Request::FaultShow { id: 3 })),
            ("clear 3", Some(Request::FaultClear { id: Some(3) })),
            ("clear --all", Some(Request::FaultClear { id: None })),
            ("clear", None),
            ("clear 3 --all", None),
            ("show", None),
            ("show x", None),
            ("inject", None),
            ("list --application a --socket b", None),
        ] {
            assert_eq!(asked(line), expected, "{line}");
        }
    }
}
