//! How a command that only writes ends.

use std::io::{self, Write as _};
use std::process::ExitCode;

use super::exit_code;

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
