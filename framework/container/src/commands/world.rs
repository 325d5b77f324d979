//! `steadfast world`: the simulated world of a supervised run, in a process of its own. Started by
//! the parent of such a run, not by people.

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use container::outer_supervision::{die_with_parent, take_line};
use container::world::serve;

use super::run::{Failed, exit_code, simulation};

/// Which world.
#[derive(Debug, Args)]
pub struct WorldArguments {
    /// The world file
    file: PathBuf,
    /// Its seed
    #[arg(long)]
    seed: u64,
    /// The process with which it ends
    #[arg(long)]
    parent: i32,
}

/// Moves a world until the parent ends.
pub fn run(arguments: &WorldArguments) -> ExitCode {
    match serve_parent(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "{}", failed.text.trim_end());
            ExitCode::from(failed.code)
        }
    }
}

fn serve_parent(arguments: &WorldArguments) -> Result<(), Failed> {
    let system = |error: io::Error| Failed {
        code: exit_code::SYSTEM,
        text: format!(
            "the simulated world cannot run: {error}\n  help: it is started by 'steadfast run --supervised'"
        ),
    };
    die_with_parent(arguments.parent).map_err(system)?;
    let line = take_line().map_err(system)?;
    let simulation = simulation(&arguments.file, arguments.seed)?;
    serve(simulation, line).map_err(system)
}
