//! `steadfast tree`: files of behaviour trees.

mod drawing;
mod log;
mod trial;

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use behavior_tree::{CompileOptions, Plan, Value};
use clap::{Args, Subcommand, ValueEnum};
use system_profile::{FileReport, Severity, TreeOptions, TreeOutcome, load_trees};

use super::check::{self, Format};
use super::{exit_code, manual, output, problems};
use log::LogArguments;
use trial::TrialArguments;

/// What `steadfast tree` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = manual::TREE)]
pub struct TreeArguments {
    #[command(subcommand)]
    command: TreeCommand,
}

#[derive(Debug, Subcommand)]
enum TreeCommand {
    /// List every problem of files of trees, with its place and what to do about it
    #[command(after_long_help = manual::TREE)]
    Check(CheckArguments),
    /// Draw a tree with its sub-trees in place
    #[command(after_long_help = manual::TREE)]
    Show(ShowArguments),
    /// Tick a tree in simulated time and print what changes
    #[command(after_long_help = manual::TREE)]
    Run(TrialArguments),
    /// Tell or draw what the trees of a run did, from its event file
    #[command(after_long_help = manual::TREE)]
    Log(LogArguments),
}

/// How files of trees are read.
#[derive(Debug, Args)]
struct ReadingArguments {
    /// Take nodes that nobody describes for stubs
    #[arg(long)]
    stubs: bool,
    /// A file whose node models and trees are known, too; may be given several times
    #[arg(long, value_name = "FILE")]
    models: Vec<PathBuf>,
    /// A name that scripts may use for a number or a text; may be given several times
    #[arg(long = "constant", value_name = "NAME=VALUE", value_parser = assignment)]
    constants: Vec<(String, String)>,
}

#[derive(Debug, Args)]
struct CheckArguments {
    /// Files of trees
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    reading: ReadingArguments,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Human)]
    format: Format,
    /// Warnings count as problems
    #[arg(long)]
    strict: bool,
}

#[derive(Debug, Args)]
struct ShowArguments {
    /// A file of trees
    file: PathBuf,
    /// The tree; without it the one that the file names, or its only one
    #[arg(long, value_name = "ID")]
    tree: Option<String>,
    #[command(flatten)]
    reading: ReadingArguments,
    /// How the tree is drawn
    #[arg(long, value_enum, default_value_t = Drawing::Text)]
    format: Drawing,
}

/// How a tree is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Drawing {
    /// For people: one line for each node
    Text,
    /// A flow chart that GitHub and other pages draw
    Mermaid,
    /// For programs: one JSON object
    Json,
}

impl ReadingArguments {
    fn options(&self, main: Option<&String>) -> TreeOptions {
        let constants = self.constants.iter();
        TreeOptions {
            compile: CompileOptions {
                stubs: self.stubs,
                constants: constants
                    .map(|(name, value)| (name.clone(), Value::of_literal(value)))
                    .collect(),
            },
            models: self.models.clone(),
            main: main.cloned(),
        }
    }
}

/// Does what was asked for.
pub fn run(arguments: &TreeArguments) -> ExitCode {
    match &arguments.command {
        TreeCommand::Check(arguments) => check(arguments),
        TreeCommand::Show(arguments) => show(arguments),
        TreeCommand::Run(arguments) => trial::run(arguments),
        TreeCommand::Log(arguments) => log::run(arguments),
    }
}

fn check(arguments: &CheckArguments) -> ExitCode {
    let options = arguments.reading.options(None);
    let mut reports: Vec<FileReport> = Vec::new();
    for file in &arguments.files {
        let mut found = load_trees(file, &options).files.into_iter();
        reports.extend(found.next());
        // Of what a file includes only the problems, and those once.
        let known = |report: &FileReport| reports.iter().any(|other| other.path == report.path);
        let new: Vec<FileReport> = found
            .filter(|report| !report.problems.is_empty() && !known(report))
            .collect();
        reports.extend(new);
    }
    let written = match arguments.format {
        Format::Human => check::write_human(&reports),
        Format::Json => check::write_json(&reports, false),
    };
    output::finish(
        "tree",
        written,
        check::exit_code(&reports, arguments.strict),
    )
}

fn show(arguments: &ShowArguments) -> ExitCode {
    let options = arguments.reading.options(arguments.tree.as_ref());
    let plan = match load(&arguments.file, &options) {
        Ok(plan) => plan,
        Err(code) => return code,
    };
    let text = match arguments.format {
        Drawing::Text => drawing::text(&plan),
        Drawing::Mermaid => drawing::mermaid(&plan),
        Drawing::Json => format!("{:#}\n", drawing::json(&plan)),
    };
    output::finish("tree", write(&text), exit_code::DONE)
}

/// The plan of a file; what is wrong with it has been told where there is none.
fn load(path: &Path, options: &TreeOptions) -> Result<Plan, ExitCode> {
    let TreeOutcome {
        plan,
        undecided,
        files,
    } = load_trees(path, options);
    if let Some(plan) = plan {
        return Ok(plan);
    }
    let all = files.iter().flat_map(|file| &file.problems);
    let errors: Vec<_> = all
        .filter(|problem| problem.severity == Severity::Error)
        .cloned()
        .collect();
    let mut text = problems::render(&errors, false);
    if let Some(reason) = undecided {
        text.push_str(&format!(
            "steadfast tree: {}: {reason}\n  help: choose a tree with --tree ID\n",
            path.display()
        ));
    }
    // If nobody reads the text the exit code still tells.
    let _unread = io::stderr().write_all(text.as_bytes());
    let is_unreadable = files.iter().any(|file| !file.readable);
    Err(ExitCode::from(match is_unreadable {
        true => exit_code::FILE,
        false => exit_code::REFUSED,
    }))
}

fn write(text: &str) -> io::Result<()> {
    let mut output = io::stdout().lock();
    output.write_all(text.as_bytes())?;
    output.flush()
}

/// `NAME=VALUE`.
fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.to_owned()))
        }
        _ => Err("write NAME=VALUE".to_owned()),
    }
}
