//! The processes that measure: started one after the other, their samples read from what they print.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde::de::DeserializeOwned;

use super::application::Batch;
use super::evaluation::Row;
use super::floor::Operation;

/// The operations of the floor, measured so many times each by a process of its own.
///
/// # Errors
/// If that process fails.
pub(super) fn measure_floor(library_path: &[PathBuf], n: u32) -> io::Result<Vec<Operation>> {
    let mut command = command("floor", library_path)?;
    output(command.args(["--n", &n.to_string()]))
}

/// The rows of a batch, measured by a process of its own in a folder that is removed afterwards.
///
/// # Errors
/// If that process fails.
pub(super) fn measure_batch(library_path: &[PathBuf], batch: &Batch) -> io::Result<Vec<Row>> {
    let folder = tempfile::tempdir()?;
    let mut command = command("batch", library_path)?;
    command.arg("--folder").arg(folder.path());
    output(command.arg(serde_json::to_string(batch)?))
}

fn command(study: &str, library_path: &[PathBuf]) -> io::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["bench", study]);
    for folder in library_path {
        command.arg("--library-path").arg(folder);
    }
    Ok(command)
}

/// What a process prints, as JSON. Its complaints go where ours go.
fn output<T: DeserializeOwned>(command: &mut Command) -> io::Result<T> {
    let finished = command
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()?;
    if !finished.status.success() {
        let program = Path::new(command.get_program()).display().to_string();
        let arguments: Vec<_> = command.get_args().map(|it| it.to_string_lossy()).collect();
        return Err(io::Error::other(format!(
            "'{program} {}' failed: {}",
            arguments.join(" "),
            finished.status
        )));
    }
    Ok(serde_json::from_slice(&finished.stdout)?)
}
