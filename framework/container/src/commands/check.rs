//! `steadfast check`: every problem of profiles, applications and what they refer to.

use std::collections::HashSet;
use std::fs::{DirEntry, File};
use std::io::{self, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use system_profile::{FileReport, LoadOptions, Problem, Severity, check_file};

use super::{output, problems};

/// All is well.
const GOOD: u8 = 0;
/// A file has an error, or a warning that counts.
const PROBLEMS: u8 = 1;
/// A file is missing or cannot be read at all.
const CANNOT_READ: u8 = 2;

/// What `steadfast check` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::CHECK)]
pub struct CheckArguments {
    /// XML files to check; a folder stands for all XML files in it
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Human)]
    format: Format,
    /// Warnings count as problems
    #[arg(long)]
    strict: bool,
    /// Add the facts found in each file (with --format json)
    #[arg(long)]
    reading: bool,
    /// Also look for referenced files in this folder; may be given several times
    #[arg(long = "search-path", value_name = "FOLDER")]
    search_paths: Vec<PathBuf>,
}

/// How the result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// For people: each problem with the offending text underlined
    Human,
    /// For programs: one JSON object
    Json,
}

/// Checks the files and writes the result to standard output.
///
/// The exit code is 0 if all is well, 1 if there are problems, 2 if a file cannot be read.
pub fn run(arguments: &CheckArguments) -> ExitCode {
    let reports = reports(arguments);
    let written = match arguments.format {
        Format::Human => write_human(&reports),
        Format::Json => write_json(&reports, arguments.reading),
    };
    output::finish("check", written, exit_code(&reports, arguments.strict))
}

fn reports(arguments: &CheckArguments) -> Vec<FileReport> {
    let options = LoadOptions {
        search_paths: arguments.search_paths.clone(),
        dangling: Severity::Warning,
    };
    let mut named = Vec::new();
    for path in &arguments.files {
        if path.is_dir() {
            collect(path, &mut named);
        } else {
            named.push(path.clone());
        }
    }
    let identity = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let mut reported: HashSet<PathBuf> = named.iter().map(|path| identity(path)).collect();
    let mut reports = Vec::new();
    for path in &named {
        let mut found = check_file(path, &options).into_iter();
        reports.extend(found.next());
        // A referenced file that is named as well has, or will have, a report of its own.
        reports.extend(found.filter(|report| reported.insert(identity(&report.path))));
    }
    reports
}

/// All XML files of a folder, sorted. Links to folders are not followed: they may lead in a circle.
/// A folder that cannot be listed is left to the opener of files, which says why.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        files.push(folder.to_owned());
        return;
    };
    let mut entries: Vec<DirEntry> = entries.flatten().collect();
    entries.sort_by_key(DirEntry::path);
    for entry in entries {
        let path = entry.path();
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            collect(&path, files);
        } else if looks_like_xml(&path) {
            files.push(path);
        }
    }
}

/// Named `*.xml`, or without an ending and beginning with an XML declaration: a few of the public
/// profiles were saved that way.
fn looks_like_xml(path: &Path) -> bool {
    const DECLARATION: &[u8] = b"<?xml";
    match path.extension() {
        Some(ending) => ending.eq_ignore_ascii_case("xml") && !path.is_dir(),
        None if path.is_file() => {
            let mut head = [0; DECLARATION.len()];
            let read = File::open(path).and_then(|mut file| file.read_exact(&mut head));
            read.is_ok() && head == DECLARATION
        }
        None => false,
    }
}

pub(super) fn exit_code(reports: &[FileReport], strict: bool) -> u8 {
    let counts = |problem: &Problem| match problem.severity {
        Severity::Error => true,
        Severity::Warning => strict,
        Severity::Note => false,
    };
    if reports.iter().any(|report| !report.readable) {
        CANNOT_READ
    } else if reports
        .iter()
        .flat_map(|report| &report.problems)
        .any(counts)
    {
        PROBLEMS
    } else {
        GOOD
    }
}

pub(super) fn write_json(reports: &[FileReport], with_reading: bool) -> io::Result<()> {
    let files: Value = reports
        .iter()
        .map(|report| {
            let mut file = json!({
                "path": report.path.to_string_lossy(),
                "sha256": report.sha256,
                "problems": report.problems.iter().map(problem_as_json).collect::<Value>(),
            });
            if with_reading {
                file["reading"] = report.reading.clone();
            }
            file
        })
        .collect();
    let mut output = io::BufWriter::new(io::stdout().lock());
    serde_json::to_writer_pretty(&mut output, &json!({ "files": files }))?;
    writeln!(output)?;
    output.flush()
}

fn problem_as_json(problem: &Problem) -> Value {
    json!({
        "severity": problem.severity.name(),
        "line": problem.place.line,
        "column": problem.place.column,
        "message": problem.message,
        "help": problem.help,
    })
}

pub(super) fn write_human(reports: &[FileReport]) -> io::Result<()> {
    let colours = io::stdout().is_terminal();
    let mut output = io::BufWriter::new(io::stdout().lock());
    for report in reports {
        problems::write(&mut output, &report.problems, colours)?;
    }
    writeln!(output, "{}", summary(reports))?;
    output.flush()
}

fn summary(reports: &[FileReport]) -> String {
    let count = |severity: Severity| {
        let problems = reports.iter().flat_map(|report| &report.problems);
        problems
            .filter(|problem| problem.severity == severity)
            .count()
    };
    let unreadable = reports.iter().filter(|report| !report.readable).count();
    let mut parts = vec![
        counted(reports.len(), "file"),
        counted(count(Severity::Error), "error"),
        counted(count(Severity::Warning), "warning"),
    ];
    match count(Severity::Note) {
        0 => {}
        notes => parts.push(counted(notes, "note")),
    }
    if unreadable > 0 {
        parts.push(format!("{} could not be read", counted(unreadable, "file")));
    }
    parts.join(", ")
}

fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(severities: &[Severity], readable: bool) -> FileReport {
        let source = std::sync::Arc::new(system_profile::Source::new("f.xml", "<a>\n</a>"));
        let problem = |severity: &Severity| {
            Problem::new(*severity, &source, 4..8, "odd", Some("mend it".into()))
        };
        FileReport {
            path: "f.xml".into(),
            sha256: None,
            readable,
            problems: severities.iter().map(problem).collect(),
            reading: Value::Null,
        }
    }

    #[test]
    fn the_worst_file_decides_the_exit_code() {
        use Severity::{Error, Warning};
        let code = |strict, severities: &[Severity]| {
            exit_code(&[report(&[], true), report(severities, true)], strict)
        };
        assert_eq!(code(true, &[]), GOOD);
        assert_eq!(code(false, &[Warning]), GOOD);
        assert_eq!(code(true, &[Warning]), PROBLEMS);
        assert_eq!(code(false, &[Warning, Error]), PROBLEMS);
        let unreadable = [report(&[Error], true), report(&[Error], false)];
        assert_eq!(exit_code(&unreadable, false), CANNOT_READ);
    }

    #[test]
    fn a_problem_as_json_has_all_its_keys() {
        let report = report(&[Severity::Warning], true);
        assert_eq!(
            problem_as_json(&report.problems[0]),
            json!({
                "severity": "warning", "line": 2, "column": 1, "message": "odd", "help": "mend it"
            })
        );
    }

    #[test]
    fn the_summary_counts_in_words() {
        let reports = [
            report(&[Severity::Error], true),
            report(&[Severity::Error, Severity::Warning], false),
        ];
        assert_eq!(
            summary(&reports),
            "2 files, 2 errors, 1 warning, 1 file could not be read"
        );
    }
}
