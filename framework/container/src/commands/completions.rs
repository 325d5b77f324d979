//! `steadfast completions`: what a shell needs to complete commands and options.

use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::{Args, Command};
use clap_complete::{Shell, generate};

use super::{exit_code, manual, output};

/// What `steadfast completions` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = manual::COMPLETIONS)]
pub struct CompletionsArguments {
    /// The shell
    shell: Shell,
}

/// Prints the completions of all commands.
pub fn run(arguments: &CompletionsArguments, mut command: Command) -> ExitCode {
    let mut script = Vec::new();
    generate(arguments.shell, &mut command, "steadfast", &mut script);
    let mut output = io::stdout().lock();
    let written = output.write_all(&script).and_then(|()| output.flush());
    output::finish("completions", written, exit_code::DONE)
}
