//! Where sockets lie: a folder that belongs to the user alone, one socket for each running
//! application.

use std::fs::DirBuilder;
use std::io;
use std::os::unix::fs::{DirBuilderExt as _, FileTypeExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};

use rustix::io::Errno;
use rustix::process::{Pid, geteuid, test_kill_process};

/// A path of a socket has at most 107 bytes; the name of an application takes no more than these.
const MAX_NAME_LENGTH: usize = 40;

const ENDING: &str = ".sock";

/// Between the names of several applications of one process.
const BETWEEN_NAMES: char = '+';

/// Everything that group and others may do.
const NOT_OWNER: u32 = 0o077;

/// Why there is no socket.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// The folder is not the user's alone.
    #[error("{folder} {reason}\n  help: remove it, or set XDG_RUNTIME_DIR to a folder of your own")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// This process has a socket for an application of that name already.
    #[error("this process runs an application '{0}' already")]
    Taken(String),
    /// The system refuses.
    #[error(
        "the socket {path} cannot be made: {error}\n  help: set XDG_RUNTIME_DIR to a folder of your own"
    )]
    Socket {
        /// The socket.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
}

/// A socket that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunningApplication {
    /// Name of the application, as far as a file name can hold it.
    pub application: String,
    /// Process that runs it.
    pub process: i32,
    /// The socket.
    pub socket: PathBuf,
}

impl RunningApplication {
    /// Whether it may be the application of this name, or have it among several.
    pub fn is_called(&self, application: &str) -> bool {
        let wanted = file_name_of(application);
        let mut several = self.application.split(BETWEEN_NAMES);
        self.application == wanted || several.any(|one| one == wanted)
    }
}

/// The running applications of this user, by name and process.
///
/// # Errors
/// If the folder cannot be trusted or read. That there is none means only that nothing runs.
pub fn running() -> Result<Vec<RunningApplication>, ControlError> {
    let folder = user_folder();
    if matches!(std::fs::symlink_metadata(&folder), Err(error) if error.kind() == io::ErrorKind::NotFound)
    {
        return Ok(Vec::new());
    }
    inspect(&folder)?;
    let mut found = sockets(&folder)?;
    found.retain(|application| is_alive(application.process));
    found.sort_by(|a, b| (&a.application, a.process).cmp(&(&b.application, b.process)));
    Ok(found)
}

/// `$XDG_RUNTIME_DIR/steadfast`, which only the user can write to, or a folder in `/tmp`.
pub(super) fn user_folder() -> PathBuf {
    let runtime = std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from);
    match runtime.filter(|folder| folder.is_absolute() && folder.is_dir()) {
        Some(folder) => folder.join("steadfast"),
        None => PathBuf::from(format!("/tmp/steadfast-{}", geteuid().as_raw())),
    }
}

/// Makes the folder if need be, makes sure that it is the user's alone, removes the sockets of dead
/// processes, and returns where that of this process belongs.
pub(super) fn prepare(folder: &Path, application: &str) -> Result<PathBuf, ControlError> {
    let made = DirBuilder::new().mode(0o700).create(folder);
    match made {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
            return Err(refused(folder, format!("cannot be made: {error}")));
        }
        _ => inspect(folder)?,
    }
    remove_stale(folder)?;
    let process = std::process::id();
    let name = format!("{}-{process}{ENDING}", file_name_of(application));
    Ok(folder.join(name))
}

/// Removes what processes of this user that were killed have left behind. What cannot be looked at is
/// left as it is.
pub fn remove_sockets_of_the_dead() {
    let folder = user_folder();
    if inspect(&folder).is_ok() {
        let _left = remove_stale(&folder);
    }
}

fn remove_stale(folder: &Path) -> Result<(), ControlError> {
    for stale in sockets(folder)? {
        if !is_alive(stale.process) {
            // Another process may have removed it first.
            let _gone = std::fs::remove_file(stale.socket);
        }
    }
    Ok(())
}

/// A folder that another user could have put there, or can write to, is not used.
fn inspect(folder: &Path) -> Result<(), ControlError> {
    let metadata = std::fs::symlink_metadata(folder)
        .map_err(|error| refused(folder, format!("cannot be looked at: {error}")))?;
    let reason = if !metadata.is_dir() {
        "is no folder".to_owned()
    } else if metadata.uid() != geteuid().as_raw() {
        format!("belongs to user {}", metadata.uid())
    } else if metadata.mode() & NOT_OWNER != 0 {
        format!("is open to others (mode {:o})", metadata.mode() & 0o777)
    } else {
        return Ok(());
    };
    Err(refused(folder, reason))
}

fn refused(folder: &Path, reason: String) -> ControlError {
    ControlError::Folder {
        folder: folder.to_owned(),
        reason,
    }
}

fn sockets(folder: &Path) -> Result<Vec<RunningApplication>, ControlError> {
    let entries = std::fs::read_dir(folder)
        .map_err(|error| refused(folder, format!("cannot be read: {error}")))?;
    let sockets = entries.filter_map(|entry| {
        let entry = entry.ok()?;
        let is_socket = entry.file_type().ok()?.is_socket();
        let (application, process) = parse(entry.file_name().to_str()?)?;
        is_socket.then(|| RunningApplication {
            application,
            process,
            socket: entry.path(),
        })
    });
    Ok(sockets.collect())
}

/// `patrol-4711.sock`
fn parse(file_name: &str) -> Option<(String, i32)> {
    let (application, process) = file_name.strip_suffix(ENDING)?.rsplit_once('-')?;
    let process: i32 = process.parse().ok().filter(|process| *process > 0)?;
    Some((application.to_owned(), process))
}

/// A process that may not be signalled is alive.
fn is_alive(process: i32) -> bool {
    let process = Pid::from_raw(process);
    process.is_some_and(|process| test_kill_process(process) != Err(Errno::SRCH))
}

/// What of a name can stand in the name of a file.
fn file_name_of(application: &str) -> String {
    let kept = |letter: char| match letter {
        '.' | '_' | '-' | BETWEEN_NAMES => letter,
        letter if letter.is_ascii_alphanumeric() => letter,
        _ => '_',
    };
    application
        .chars()
        .take(MAX_NAME_LENGTH)
        .map(kept)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    use std::os::unix::net::UnixListener;

    use super::*;

    /// Processes have no numbers this high: the kernel's limit is 2^22.
    const DEAD: i32 = 2_000_000_000;

    #[test]
    fn names_of_sockets() {
        for (name, expected) in [
            ("patrol-4711.sock", Some(("patrol", 4711))),
            ("a-b-1.sock", Some(("a-b", 1))),
            ("patrol.sock", None),
            ("patrol-x.sock", None),
            ("patrol--1.sock", Some(("patrol-", 1))),
            ("patrol-0.sock", None),
            ("patrol-1.txt", None),
        ] {
            let expected = expected.map(|(name, process)| (name.to_owned(), process));
            assert_eq!(parse(name), expected, "{name}");
        }
        assert_eq!(file_name_of("../my robot/글"), ".._my_robot__");
        assert_eq!(file_name_of(&"n".repeat(200)).len(), MAX_NAME_LENGTH);
    }

    #[test]
    fn one_of_several_applications_can_be_meant() {
        let running = RunningApplication {
            application: file_name_of("hri+local isation"),
            process: 1,
            socket: PathBuf::new(),
        };
        for (name, expected) in [
            ("hri", true),
            ("local isation", true),
            ("hri+local isation", true),
            ("isation", false),
        ] {
            assert_eq!(running.is_called(name), expected, "{name}");
        }
    }

    #[test]
    fn only_sockets_of_the_dead_are_removed() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("steadfast");
        prepare(&folder, "patrol").unwrap();
        let mode = std::fs::metadata(&folder).unwrap().mode();
        assert_eq!(mode & 0o777, 0o700);
        let stale = folder.join(format!("patrol-{DEAD}.sock"));
        let live = folder.join(format!("patrol-{}.sock", std::process::id()));
        let _sockets = [&stale, &live].map(|path| UnixListener::bind(path).unwrap());
        let file = folder.join(format!("mapping-{DEAD}.sock"));
        std::fs::write(&file, "no socket").unwrap();
        assert_eq!(prepare(&folder, "patrol").unwrap(), live);
        assert!(!stale.exists() && live.exists() && file.exists());
    }

    #[test]
    fn a_folder_that_others_may_touch_is_refused() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("steadfast");
        let refusal = || prepare(&folder, "patrol").unwrap_err().to_string();
        std::fs::write(&folder, "").unwrap();
        assert!(refusal().contains("is no folder"));
        std::fs::remove_file(&folder).unwrap();
        let elsewhere = outer.path().join("elsewhere");
        std::fs::create_dir(&elsewhere).unwrap();
        symlink(&elsewhere, &folder).unwrap();
        assert!(refusal().contains("is no folder"));
        std::fs::remove_file(&folder).unwrap();
        std::fs::create_dir(&folder).unwrap();
        for mode in [0o770, 0o701, 0o755] {
            std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(mode)).unwrap();
            assert!(refusal().contains(&format!("(mode {mode:o})")));
        }
    }
}
