//! A folder that nobody else may enter, and that is removed when it is not needed any more.

use std::fs::DirBuilder;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use crate::commands::run::{Failed, unwritable};

/// The folder.
pub(super) struct PrivateFolder(PathBuf);

impl PrivateFolder {
    /// Makes one among the system's temporary files. One that is there already is somebody else's,
    /// and is not taken.
    pub(super) fn new() -> Result<Self, Failed> {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let name = format!(
            "steadfast-sent-{}-{}",
            std::process::id(),
            since.unwrap_or_default().as_nanos()
        );
        let path = std::env::temp_dir().join(name);
        let made = DirBuilder::new().mode(0o700).create(&path);
        made.map_err(|error| unwritable(Some(&path), &error))?;
        Ok(Self(path))
    }

    pub(super) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for PrivateFolder {
    fn drop(&mut self) {
        // What cannot be removed lies where nobody looks for components.
        let _left = std::fs::remove_dir_all(&self.0);
    }
}
