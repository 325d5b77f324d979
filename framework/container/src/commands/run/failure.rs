//! Why a run did not start or did not end well, as exit code and text.

use std::io;
use std::path::Path;

use container::assembly::AssemblyProblem;
use container::system::StartError;

/// Exit codes of `run`, by kind; the manual of the command lists them.
pub(in crate::commands) mod exit_code {
    pub const ENDED: u8 = 0;
    pub const PROFILE: u8 = 1;
    pub const FILE: u8 = 2;
    pub const LIBRARY: u8 = 3;
    pub const CONNECTION: u8 = 4;
    pub const COMPONENT: u8 = 5;
    pub const SYSTEM: u8 = 6;
}

/// Why there is nothing (more) to run: exit code and text.
pub(in crate::commands) struct Failed {
    pub(in crate::commands) code: u8,
    pub(in crate::commands) text: String,
}

/// Applications that did not start.
pub(super) fn refused(error: &StartError) -> Failed {
    let code = match error {
        StartError::Assembly(problems) => match problems.first() {
            Some(AssemblyProblem::Connection { .. }) => exit_code::CONNECTION,
            Some(AssemblyProblem::Resources { .. }) => exit_code::SYSTEM,
            Some(AssemblyProblem::Library { .. }) | None => exit_code::LIBRARY,
        },
        StartError::Components(_)
        | StartError::Hangs { .. }
        | StartError::NothingToBackUp { .. } => exit_code::COMPONENT,
        StartError::Output { .. } => exit_code::FILE,
        StartError::System(_) => exit_code::SYSTEM,
    };
    Failed {
        code,
        text: error.to_string(),
    }
}

/// A file that was asked for and cannot be written.
pub(in crate::commands) fn unwritable(path: Option<&Path>, error: &io::Error) -> Failed {
    let name = path.map_or_else(
        || "the output".to_owned(),
        |path| path.display().to_string(),
    );
    Failed {
        code: exit_code::FILE,
        text: format!("{name} cannot be written: {error}"),
    }
}
