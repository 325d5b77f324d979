//! `steadfast new`: projects that build, run and pass their own test at once.

mod name;
mod project;
mod sdk;

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Subcommand, ValueEnum};
use serde_json::json;

use super::run::Failed;
use super::{exit_code, manual, output};
use project::Kind;
use sdk::Sdk;

/// What `steadfast new` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = manual::NEW)]
pub struct NewArguments {
    #[command(subcommand)]
    what: What,
    /// A clone of Steadfast, whose SDK the project uses; looked for upward from this executable and
    /// from the current folder unless given
    #[arg(long, global = true, value_name = "FOLDER")]
    sdk: Option<PathBuf>,
    /// How the result is written
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Debug, Subcommand)]
enum What {
    /// A component: a library with its profile, an application to try it in, and its test
    Component {
        /// Its name, also that of its folder: small letters, digits and `_`
        name: String,
        /// What it is written in
        #[arg(long, value_enum, default_value_t = Language::Rust)]
        language: Language,
    },
    /// An application: two components, rules, injections, and a test of all of them
    Application {
        /// Its name, also that of its folder: small letters, digits and `_`
        name: String,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Language {
    /// With cargo
    Rust,
    /// C11, with make
    C,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: what was written, and what to do next
    Text,
    /// For programs: one JSON object
    Json,
}

/// Writes a project into a new folder of the current one.
pub fn run(arguments: &NewArguments) -> ExitCode {
    match write(arguments) {
        Ok((folder, kind, files)) => {
            let text = match arguments.format {
                Format::Text => for_people(&folder, kind, &files),
                Format::Json => {
                    let object = json!({ "folder": folder, "files": files, "next": kind.next() });
                    format!("{object:#}\n")
                }
            };
            let mut output = io::stdout().lock();
            let written = output
                .write_all(text.as_bytes())
                .and_then(|()| output.flush());
            output::finish("new", written, exit_code::DONE)
        }
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "{}", failed.text);
            ExitCode::from(failed.code)
        }
    }
}

fn for_people(folder: &Path, kind: Kind, files: &[String]) -> String {
    let mut text = format!("{} holds\n", folder.display());
    for file in files {
        text += &format!("  {file}\n");
    }
    text += &format!("\nNext:\n  cd {}\n", folder.display());
    for command in kind.next() {
        text += &format!("  {command}\n");
    }
    text
}

fn write(arguments: &NewArguments) -> Result<(PathBuf, Kind, Vec<String>), Failed> {
    let (name, kind) = match &arguments.what {
        What::Component { name, language } => match language {
            Language::Rust => (name, Kind::RustComponent),
            Language::C => (name, Kind::CComponent),
        },
        What::Application { name } => (name, Kind::Application),
    };
    name::check(name).map_err(|text| Failed {
        code: exit_code::REFUSED,
        text,
    })?;
    let sdk = Sdk::find(arguments.sdk.as_deref())?;
    let folder = PathBuf::from(name);
    let files = project::write(kind, name, &sdk, &folder)?;
    Ok((folder, kind, files))
}
