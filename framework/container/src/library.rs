//! Component libraries: found by the names that profiles use, loaded as private copies, checked
//! before anything in them runs.

mod copy;
mod description;
mod load;
mod probe;
mod search;

pub(crate) use copy::{hand_over, sealed, whole};
pub use description::{ComponentDescription, MethodDescription, PortDescription};
pub use load::LoadedLibrary;
pub use probe::{probe, probe_main};
pub use search::{LibrarySearch, file_name};

use std::path::PathBuf;

/// Why a library cannot be used. Each variant says whose fault it is and what to do.
#[derive(Debug, thiserror::Error)]
pub enum LibraryError {
    /// No file of that name.
    #[error(
        "library '{name}' was not found\n  looked for {} in {}\n  help: build the component, or name its folder with --library-path",
        .candidates.join(", "),
        .directories.iter().map(|directory| directory.display().to_string()).collect::<Vec<_>>().join(", ")
    )]
    NotFound {
        /// As the profile has it.
        name: String,
        /// File names that were tried.
        candidates: Vec<String>,
        /// Folders that were searched.
        directories: Vec<PathBuf>,
    },
    /// The name leads out of the search path.
    #[error(
        "library name '{0}' leads outside the search path\n  help: name the file alone and put its folder on --library-path"
    )]
    OutsideSearchPath(String),
    /// The file cannot be read.
    #[error(
        "library {} cannot be read: {error}\n  help: see that the file may be read by you",
        .path.display()
    )]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The loader refuses it.
    #[error(
        "{} is no shared library that this machine can load: {reason}\n  help: rebuild it for this machine, as a `cdylib`",
        .path.display()
    )]
    NotALibrary {
        /// The file.
        path: PathBuf,
        /// The loader's words.
        reason: String,
    },
    /// It crashed or hung while it was loaded in a separate process.
    #[error(
        "{} cannot be loaded safely: {reason}\n  help: its constructors or descriptors are faulty; ask its author",
        .path.display()
    )]
    Unsafe {
        /// The file.
        path: PathBuf,
        /// What happened.
        reason: String,
    },
    /// It has no descriptor.
    #[error(
        "{} is a library but no component: it does not export '{symbol}'\n  help: export one with `export_component!` (Rust) or by component.h (C)",
        .path.display()
    )]
    NoComponent {
        /// The file.
        path: PathBuf,
        /// The symbol that is missing.
        symbol: &'static str,
    },
    /// Its descriptor is for another container.
    #[error(
        "{} was built for component ABI {theirs}, this container has {ours}\n  help: rebuild it with the component-sdk or component.h of this container",
        .path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        theirs: String,
        /// This container's.
        ours: String,
    },
    /// The descriptor is there, but what it says cannot be.
    #[error("the descriptor of {} is wrong: {reason}\n  help: this is the component author's fault", .path.display())]
    Descriptor {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}
