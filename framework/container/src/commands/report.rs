//! `steadfast report`: what happened in a run, as one HTML file that needs nothing else.

mod amounts;
mod evidence;
mod faults;
mod figures;
mod gathering;
mod levels;
mod map;
mod markup;
mod model;
mod page;
mod paragraph;
mod plot;
mod reading;
mod scale;
mod signals;
mod timeline;

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use super::run::Failed;
use super::{exit_code, output};
use model::Run;

/// What `steadfast report` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::REPORT)]
pub struct ReportArguments {
    /// What `steadfast run` wrote with --events, --record or --black-box; a recording of a run whose
    /// events are given too is part of that run
    #[arg(required = true, value_name = "EVENTS.jsonl|RUN.mcap")]
    runs: Vec<PathBuf>,
    /// The summary of the run; of several runs in their order
    #[arg(long, value_name = "FILE.json")]
    summary: Vec<PathBuf>,
    /// The picture of the drive; of several runs in their order
    #[arg(long, value_name = "DRIVE.svg")]
    picture: Vec<PathBuf>,
    /// The page
    #[arg(long, value_name = "REPORT.html")]
    output: PathBuf,
    /// How the result is told
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// How the result is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: a line for each run
    Text,
    /// For programs: one JSON object
    Json,
}

/// Makes the page.
pub fn run(arguments: &ReportArguments) -> ExitCode {
    match report(arguments) {
        Ok(told) => {
            let mut output = io::stdout().lock();
            let written = output.write_all(told.as_bytes());
            let written = written.and_then(|()| output.flush());
            output::finish("report", written, exit_code::DONE)
        }
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "{}", failed.text.trim_end());
            ExitCode::from(failed.code)
        }
    }
}

fn report(arguments: &ReportArguments) -> Result<String, Failed> {
    let mut runs = reading::read(&arguments.runs)?;
    check_count("--summary", &arguments.summary, &runs)?;
    check_count("--picture", &arguments.picture, &runs)?;
    for (run, path) in runs.iter_mut().zip(&arguments.summary) {
        run.summary = Some(reading::read_summary(path)?);
    }
    for (run, path) in runs.iter_mut().zip(&arguments.picture) {
        run.picture = Some(reading::read_picture(path)?);
    }
    let page = page::page(&runs);
    let path = &arguments.output;
    std::fs::write(path, &page).map_err(|error| Failed {
        code: exit_code::FILE,
        text: format!(
            "{} cannot be written: {error}\n  help: name a file in a folder that you may write to",
            path.display()
        ),
    })?;
    Ok(match arguments.format {
        Format::Text => in_words(arguments, &runs),
        Format::Json => {
            let runs: Vec<Value> = runs.iter().map(as_json).collect();
            let report = json!({"output": path, "bytes": page.len(), "runs": runs});
            format!("{report:#}\n")
        }
    })
}

fn check_count(option: &str, files: &[PathBuf], runs: &[Run]) -> Result<(), Failed> {
    if files.len() <= runs.len() {
        return Ok(());
    }
    Err(Failed {
        code: exit_code::USAGE,
        text: format!(
            "{option} is given {}, but the files tell of {}\n  help: events and recordings of one \
             run are one run; see 'steadfast report --help'",
            amounts::count(files.len(), "time"),
            amounts::count(runs.len(), "run")
        ),
    })
}

fn in_words(arguments: &ReportArguments, runs: &[Run]) -> String {
    let runs = runs.iter().map(|run| {
        format!(
            "  {}: {}, {} with recorded signals ({})\n",
            paragraph::name(run),
            amounts::count(run.faults.len(), "fault"),
            plotted(run),
            run.sources.join(", ")
        )
    });
    format!(
        "{}:\n{}",
        arguments.output.display(),
        runs.collect::<String>()
    )
}

fn as_json(run: &Run) -> Value {
    let faults = run.faults.iter().map(|(number, fault)| {
        let verdict = &fault.verdict;
        json!({
            "verdict": number.to_string(), "kind": verdict.kind, "component": verdict.component,
            "state": verdict.state, "plotted": fault.signal.is_some(),
        })
    });
    json!({
        "application": run.application, "sources": run.sources,
        "story": paragraph::paragraph(run), "faults": faults.collect::<Vec<_>>(),
    })
}

/// Faults whose evidence was recorded.
fn plotted(run: &Run) -> usize {
    let faults = run.faults.values();
    faults.filter(|fault| fault.signal.is_some()).count()
}
