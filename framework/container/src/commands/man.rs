//! `steadfast man`: manual pages.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Command};
use clap_mangen::Man;

use super::{exit_code, manual, output};

/// What `steadfast man` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = manual::MAN)]
pub struct ManArguments {
    /// Write the pages of all commands into this folder; without it that of `steadfast` is printed
    #[arg(long, value_name = "FOLDER")]
    output: Option<PathBuf>,
}

/// Writes the pages.
pub fn run(arguments: &ManArguments, command: Command) -> ExitCode {
    let Some(folder) = &arguments.output else {
        return output::finish("man", print(command), exit_code::DONE);
    };
    match write(folder, command) {
        Ok(()) => ExitCode::from(exit_code::DONE),
        Err(error) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(
                io::stderr(),
                "steadfast man: pages cannot be written to {}: {error}\n  help: name a folder that \
                 you may write to",
                folder.display()
            );
            ExitCode::from(exit_code::FILE)
        }
    }
}

fn print(command: Command) -> io::Result<()> {
    let mut page = Vec::new();
    Man::new(command).render(&mut page)?;
    let mut output = io::stdout().lock();
    output.write_all(&page)?;
    output.flush()
}

fn write(folder: &Path, command: Command) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    clap_mangen::generate_to(command.disable_help_subcommand(true), folder)
}
