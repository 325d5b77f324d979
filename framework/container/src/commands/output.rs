//! Results to a file or to the standard output, and how a command ends that only writes.

use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use super::exit_code;
use super::run::{Failed, unwritable};

/// The exit code after writing to standard output.
pub fn finish(command: &str, written: io::Result<()>, code: u8) -> ExitCode {
    match written {
        Ok(()) => ExitCode::from(code),
        // Whoever reads the output has seen enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::from(code),
        Err(error) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(
                io::stderr(),
                "steadfast {command}: the result cannot be written: {error}\n  help: is the disk \
                 full, or standard output closed?"
            );
            ExitCode::from(exit_code::FILE)
        }
    }
}

/// Writes `text` to a file, or to the standard output if none is named. A pipe whose reader has seen
/// enough is no failure.
///
/// # Errors
/// That it cannot be written.
pub fn write(path: Option<&Path>, text: &str) -> Result<(), Failed> {
    let written = match path {
        Some(path) => std::fs::write(path, text),
        None => {
            let mut output = io::stdout().lock();
            output
                .write_all(text.as_bytes())
                .and_then(|()| output.flush())
        }
    };
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(unwritable(path, &error)),
        _ => Ok(()),
    }
}
