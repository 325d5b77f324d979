//! Loading a library first in a process of its own: a constructor that crashes leaves the loader's
//! lock held, so the container must never be the first to load an unknown file.

use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use super::{LibraryError, LoadedLibrary};

/// The hidden command of the binary that [`probe`] starts.
const PROBE_COMMAND: &str = "probe-library";

/// Loading takes milliseconds; a constructor that takes longer than this hangs.
const PROBE_LIMIT: Duration = Duration::from_secs(10);

/// Exit codes of the probe process. Not 0 and 1: a constructor may call `exit` with those.
const LOADED: u8 = 100;
const REFUSED: u8 = 101;

/// How often the probe process is looked at.
const POLL_PERIOD: Duration = Duration::from_millis(1);

/// Loads the library at `path` in a process of its own, by `executable`.
///
/// # Errors
/// If the process dies or hangs. A library that is merely refused passes: loading it here says
/// more clearly why.
pub fn probe(executable: &Path, path: &Path) -> Result<(), LibraryError> {
    let faulty = |reason: String| LibraryError::Unsafe {
        path: path.to_owned(),
        reason,
    };
    let mut child = Command::new(executable)
        .arg(PROBE_COMMAND)
        .arg(path)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|error| faulty(format!("the probe process does not start: {error}")))?;
    let started = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => {
                return match (status.code(), status.signal()) {
                    (Some(code), _) if code == i32::from(LOADED) || code == i32::from(REFUSED) => {
                        Ok(())
                    }
                    (_, Some(signal)) => {
                        Err(faulty(format!("loading it ended by signal {signal}")))
                    }
                    (code, None) => Err(faulty(format!(
                        "loading it ended the process with code {}",
                        code.unwrap_or_default()
                    ))),
                };
            }
            Ok(None) if started.elapsed() > PROBE_LIMIT => {
                let _already_gone = child.kill();
                let _reaped = child.wait();
                return Err(faulty(format!(
                    "loading it did not end within {} s",
                    PROBE_LIMIT.as_secs()
                )));
            }
            Ok(None) => std::thread::sleep(POLL_PERIOD),
            Err(error) => return Err(faulty(format!("the probe process is lost: {error}"))),
        }
    }
}

/// What the probe process does.
pub fn probe_main(path: &Path) -> ExitCode {
    match LoadedLibrary::load(path) {
        Ok(_loaded) => ExitCode::from(LOADED),
        Err(_refused) => ExitCode::from(REFUSED),
    }
}
