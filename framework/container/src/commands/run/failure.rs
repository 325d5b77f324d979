//! Why a run did not start or did not end well, as exit code and text.

use std::io;
use std::path::Path;

use container::assembly::AssemblyProblem;
use container::system::StartError;

/// Exit codes of `run`, by kind.
pub(in crate::commands) mod exit_code {
    pub use crate::commands::exit_code::{
        COMPONENT, CONNECTION, DONE as ENDED, FILE, LIBRARY, REFUSED as PROFILE, SYSTEM, USAGE,
    };
}

/// Why there is nothing (more) to run: exit code and text.
#[derive(Debug)]
pub(in crate::commands) struct Failed {
    pub(in crate::commands) code: u8,
    pub(in crate::commands) text: String,
}

/// Applications that did not start.
pub(in crate::commands) fn refused(error: &StartError) -> Failed {
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
        StartError::System(_) | StartError::Network(_) => exit_code::SYSTEM,
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
        text: format!(
            "{name} cannot be written: {error}\n  help: name a file in a folder that you may write to"
        ),
    }
}
