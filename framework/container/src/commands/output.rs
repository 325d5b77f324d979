//! Results to a file or to the standard output.

use std::io::{self, Write as _};
use std::path::Path;

use super::run::{Failed, unwritable};

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
