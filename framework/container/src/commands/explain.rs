//! `steadfast explain`: what the rules make of an application, and what would come of a fault,
//! without a robot.

mod component;
mod page;
mod table;
mod watched;
mod what_if;

pub use page::escaped;

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use component::Explanation;
use fault_manager::what_if::{
    Assumptions, QueryError, Recoveries, Table, answer, find, input_port, parse,
};
use fault_manager::{FaultManager, Scope};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::run::applications::{self, Sources};
use super::run::{Failed, exit_code, show};

/// The question that asks for every fault of every component.
const ALL: &str = "all";

/// What `steadfast explain` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::EXPLAIN)]
pub struct ExplainArguments {
    /// Application profiles, as for `run`
    #[arg(required = true, value_name = "APPLICATION.xml")]
    applications: Vec<PathBuf>,
    /// Fault rules; may be given several times
    #[arg(long, value_name = "FILE.xml")]
    rules: Vec<PathBuf>,
    /// Also look for referenced profiles in this folder; may be given several times
    #[arg(long = "search-path", value_name = "FOLDER")]
    search_path: Vec<PathBuf>,
    /// Explain this component alone
    #[arg(long, value_name = "NAME", conflicts_with = "what_if")]
    component: Option<String>,
    /// What would be done about a fault: \"COMPONENT FAULT\", \"COMPONENT.PORT FAULT\" for a fault of
    /// data, or `all` for the table of every fault of every component
    #[arg(long, value_name = "QUESTION")]
    what_if: Option<String>,
    /// With --what-if: no recovery succeeds, so that the ladder is climbed to its end
    #[arg(long, requires = "what_if")]
    assume_recovery_fails: bool,
    /// With --what-if: what is wrong or does not come at this input is so at all outputs of its
    /// component; without that a component copes; may be given several times
    #[arg(long, value_name = "COMPONENT.PORT", requires = "what_if")]
    passes_on: Vec<String>,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Write it to this file instead of the standard output
    #[arg(long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// How the result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people
    Text,
    /// For people, with --what-if all: one page without anything from elsewhere
    Html,
    /// For programs
    Json,
}

/// Explains, and writes the result.
pub fn run(arguments: &ExplainArguments) -> ExitCode {
    match explain(arguments) {
        Ok(()) => ExitCode::from(exit_code::ENDED),
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "{}", failed.text.trim_end());
            ExitCode::from(failed.code)
        }
    }
}

fn explain(arguments: &ExplainArguments) -> Result<(), Failed> {
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
    let scopes: Vec<Scope> = scopes.collect();
    let text = match arguments.what_if.as_deref() {
        None => components(arguments, &scopes)?,
        Some(ALL) => all(arguments, &scopes)?,
        Some(question) => one(arguments, &scopes, question)?,
    };
    super::output::write(arguments.output.as_deref(), &text)
}

/// One component, or all.
fn components(arguments: &ExplainArguments, scopes: &[Scope]) -> Result<String, Failed> {
    let wanted = match &arguments.component {
        Some(text) => vec![find(scopes, text).map_err(|error| misunderstood(&error))?],
        None => {
            let all = scopes.iter().enumerate().flat_map(|(application, scope)| {
                (0..scope.specification.components.len()).map(move |one| (application, one))
            });
            all.collect()
        }
    };
    let manager = FaultManager::new(scopes.to_vec());
    let explained: Vec<Explanation> = wanted
        .into_iter()
        .map(|(application, one)| component::explain(scopes, &manager, application, one))
        .collect();
    match arguments.format {
        Format::Text => {
            let texts: Vec<String> = explained.iter().map(component::text).collect();
            Ok(texts.join("\n"))
        }
        Format::Json => Ok(pretty(&json!({ "components": explained }))),
        Format::Html => Err(refused(
            "a page is made of the table of faults: write --what-if all, or --format text",
        )),
    }
}

fn all(arguments: &ExplainArguments, scopes: &[Scope]) -> Result<String, Failed> {
    let rows = scopes
        .iter()
        .map(|scope| scope.specification.components.len());
    let bar = progress(rows.sum());
    let table = Table::new(scopes, &assumptions(arguments, scopes)?, &mut |_| {
        bar.inc(1)
    });
    bar.finish_and_clear();
    Ok(match arguments.format {
        Format::Text => table::text(scopes, &table),
        Format::Html => page::html(scopes, &table),
        Format::Json => pretty(&table::json(scopes, &table)),
    })
}

/// A bar on the error output, of so many components; hidden where that is no terminal.
fn progress(rows: usize) -> ProgressBar {
    let bar = ProgressBar::new(u64::try_from(rows).unwrap_or(u64::MAX));
    let style = ProgressStyle::with_template("{wide_bar} {pos} of {len} components");
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

fn one(arguments: &ExplainArguments, scopes: &[Scope], text: &str) -> Result<String, Failed> {
    let question = parse(scopes, text).map_err(|error| misunderstood(&error))?;
    let assumptions = assumptions(arguments, scopes)?;
    let answer =
        answer(scopes, &question, &assumptions).map_err(|error| misunderstood(&error.into()))?;
    match arguments.format {
        Format::Text => Ok(what_if::text(scopes, &question, &answer)),
        Format::Json => Ok(pretty(&what_if::json(scopes, &question, &answer))),
        Format::Html => Err(refused(
            "a page is made of the whole table: write --what-if all, or --format text",
        )),
    }
}

fn assumptions(arguments: &ExplainArguments, scopes: &[Scope]) -> Result<Assumptions, Failed> {
    let ports = arguments.passes_on.iter();
    let passes_on = ports
        .map(|text| input_port(scopes, text))
        .collect::<Result<_, QueryError>>();
    Ok(Assumptions {
        recoveries: match arguments.assume_recovery_fails {
            true => Recoveries::Fail,
            false => Recoveries::Succeed,
        },
        passes_on: passes_on.map_err(|error| misunderstood(&error))?,
    })
}

fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}

fn misunderstood(error: &QueryError) -> Failed {
    refused(&error.to_string())
}

fn refused(reason: &str) -> Failed {
    Failed {
        code: exit_code::PROFILE,
        text: format!("steadfast explain: {reason}"),
    }
}
