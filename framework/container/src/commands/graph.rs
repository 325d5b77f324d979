//! `steadfast graph`: an application as a picture: who runs where, what goes from whom to whom, and
//! what stands ready.

mod diagram;
mod dot;
mod json;
mod layout;
mod mermaid;
mod svg;

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use diagram::Diagram;
use fault_manager::Scope;

use super::run::applications::{self, Sources};
use super::run::{Failed, exit_code, show};

/// What `steadfast graph` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::GRAPH)]
pub struct GraphArguments {
    /// Application profiles, as for `run`
    #[arg(required = true, value_name = "APPLICATION.xml")]
    applications: Vec<PathBuf>,
    /// Fault rules; may be given several times
    #[arg(long, value_name = "FILE.xml")]
    rules: Vec<PathBuf>,
    /// Also look for referenced profiles in this folder; may be given several times
    #[arg(long = "search-path", value_name = "FOLDER")]
    search_path: Vec<PathBuf>,
    /// How it is written
    #[arg(long, value_enum, default_value_t = Format::Svg)]
    format: Format,
    /// Write it to this file instead of the standard output
    #[arg(long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// How a graph is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For Graphviz
    Dot,
    /// For Mermaid, as Markdown pages show it
    Mermaid,
    /// A picture, ready to be looked at
    Svg,
    /// For programs
    Json,
}

/// Draws, and writes the result.
pub fn run(arguments: &GraphArguments) -> ExitCode {
    match draw(arguments) {
        Ok(()) => ExitCode::from(exit_code::ENDED),
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "{}", failed.text.trim_end());
            ExitCode::from(failed.code)
        }
    }
}

fn draw(arguments: &GraphArguments) -> Result<(), Failed> {
    let (applications, warnings) = applications::read(&Sources {
        applications: &arguments.applications,
        rules: &arguments.rules,
        inject: &[],
        search_path: &arguments.search_path,
    })?;
    show(&warnings);
    let scopes = applications.into_iter().map(|application| Scope {
        specification: application.specification,
        rules: application.rules,
    });
    let diagram = Diagram::new(&scopes.collect::<Vec<_>>());
    let text = match arguments.format {
        Format::Dot => dot::text(&diagram),
        Format::Mermaid => mermaid::text(&diagram),
        Format::Svg => svg::text(&diagram),
        Format::Json => json::text(&diagram),
    };
    super::output::write(arguments.output.as_deref(), &text)
}
