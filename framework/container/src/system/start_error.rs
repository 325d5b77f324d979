//! Why applications did not start.

use std::path::PathBuf;

use super::{BRING_UP_LIMIT, Failure};
use robot_network::NodeError;

use crate::assembly::AssemblyProblem;

/// Why an application did not start. Nothing of it runs.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// It cannot be assembled.
    #[error("{}", list(.0))]
    Assembly(Vec<AssemblyProblem>),
    /// Components refused to be initialised or started.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Components(Vec<Failure>),
    /// Bringing it up took too long.
    #[error(
        "component '{component}' did not return within {} s from onInitialize or onStart\n  help: see its properties and the devices it opens; nothing was started",
        BRING_UP_LIMIT.as_secs()
    )]
    Hangs {
        /// Instance name.
        component: String,
    },
    /// A rule asks for checkpoints of components that register no memory.
    #[error(
        "{} registered no memory (`critical`) by the end of onStart, so there is nothing to back up\n  help: take <backup> out of the rules of {}, or let the component register its state",
        list_names(.components), list_names(.components)
    )]
    NothingToBackUp {
        /// Instance names.
        components: Vec<String>,
    },
    /// The event file cannot be written.
    #[error(
        "{} cannot be written: {error}\n  help: name a file in a folder that you may write to",
        .path.display()
    )]
    Output {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The network of robots cannot be entered.
    #[error("{0}")]
    Network(NodeError),
    /// The system refused threads or files.
    #[error(
        "the container cannot run: {0}\n  help: see the limits of this user and machine: threads, open files, memory"
    )]
    System(#[from] std::io::Error),
}

fn list_names(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
    quoted.join(", ")
}

fn list(problems: &[AssemblyProblem]) -> String {
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    lines.join("\n")
}
