//! Where libraries are found.

use std::path::{Path, PathBuf};

use container::assembly::LibraryOptions;
use container::library::LibrarySearch;

/// Folders for libraries by environment, separated by colons.
const LIBRARY_PATH_VARIABLE: &str = "STEADFAST_LIBRARY_PATH";

/// Where libraries are found and how they are probed.
pub(in crate::commands) fn libraries(library_path: &[PathBuf]) -> LibraryOptions {
    LibraryOptions {
        search: LibrarySearch::new(library_folders(library_path)),
        executable: std::env::current_exe().ok(),
    }
}

/// Folders of libraries: those given, those of the environment, then that of this executable.
pub fn library_folders(given: &[PathBuf]) -> Vec<PathBuf> {
    let mut folders = given.to_vec();
    if let Some(variable) = std::env::var_os(LIBRARY_PATH_VARIABLE) {
        folders.extend(std::env::split_paths(&variable));
    }
    let executable = std::env::current_exe().ok();
    folders.extend(
        executable
            .as_deref()
            .and_then(Path::parent)
            .map(PathBuf::from),
    );
    folders
}
