//! Where files lie: a folder of the user's, in it one folder for each application, held by one
//! container at a time.

use std::ffi::OsString;
use std::fs::{DirBuilder, File};
use std::io;
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::process::geteuid;

use super::slots::{Slots, is_of_slots};

/// How long a predecessor that was killed may take to let go: the kernel tears memory of half a
/// gigabyte down in 50 ms.
const LOCK_LIMIT: Duration = Duration::from_secs(1);

/// How often it is looked at meanwhile.
const LOCK_PERIOD: Duration = Duration::from_millis(20);

/// Writing by group and others.
const WRITABLE_BY_OTHERS: u32 = 0o022;

/// Longest name of a file; the system's limit is 255 bytes, and an ending comes behind it.
const LONGEST_NAME_BYTES: usize = 200;

/// The folder of one application, held by this process until it is dropped; the kernel lets go of it
/// when the process dies.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    _held: File,
}

/// Why there is no folder.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Nothing says where.
    #[error("neither STATE_DIRECTORY, XDG_STATE_HOME nor HOME is set; name a folder")]
    Nowhere,
    /// It cannot be made or opened.
    #[error("{} cannot be used: {error}", .folder.display())]
    Unusable {
        /// The folder.
        folder: PathBuf,
        /// The system's words.
        error: io::Error,
    },
    /// Somebody else could have written what is in it.
    #[error("{} is not this user's alone: {reason}", .folder.display())]
    NotOurs {
        /// The folder.
        folder: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Another container has it.
    #[error("{} is in use by another container", .0.display())]
    InUse(PathBuf),
}

/// The folder that was asked for, else that of the service manager (`STATE_DIRECTORY`, of several the
/// first), else the user's (`XDG_STATE_HOME`, `~/.local/state`). `variable` looks a variable up.
///
/// # Errors
/// If nothing says where.
pub fn base_folder(
    asked: Option<&Path>,
    variable: impl Fn(&str) -> Option<OsString>,
) -> Result<PathBuf, StoreError> {
    // A relative folder in a variable would depend on where the program was started.
    let absolute = |name: &str| {
        let value = variable(name)?;
        let first = std::env::split_paths(&value).next()?;
        first.is_absolute().then_some(first)
    };
    let user = || Some(absolute("XDG_STATE_HOME")?.join("steadfast"));
    let home = || Some(absolute("HOME")?.join(".local/state/steadfast"));
    asked
        .map(Path::to_owned)
        .or_else(|| absolute("STATE_DIRECTORY"))
        .or_else(user)
        .or_else(home)
        .ok_or(StoreError::Nowhere)
}

impl Store {
    /// Makes the folder of an application in `base` if need be, and takes hold of it, waiting at most
    /// a second for a predecessor that is dying.
    ///
    /// # Errors
    /// If it cannot be made, is not this user's alone, or another container has it.
    pub fn open(base: &Path, application: &str) -> Result<Self, StoreError> {
        let folder = base.join(file_name_of(application));
        let unusable = |error| StoreError::Unusable {
            folder: folder.clone(),
            error,
        };
        let mut builder = DirBuilder::new();
        builder.recursive(true).mode(0o700);
        builder.create(&folder).map_err(unusable)?;
        inspect(&folder)?;
        let held = File::open(&folder).map_err(unusable)?;
        let start = Instant::now();
        loop {
            match held.try_lock() {
                Ok(()) => break,
                Err(std::fs::TryLockError::Error(error)) => return Err(unusable(error)),
                Err(std::fs::TryLockError::WouldBlock) if start.elapsed() > LOCK_LIMIT => {
                    return Err(StoreError::InUse(folder));
                }
                Err(std::fs::TryLockError::WouldBlock) => std::thread::sleep(LOCK_PERIOD),
            }
        }
        Ok(Self {
            folder,
            _held: held,
        })
    }

    /// The files of one component.
    pub fn slots(&self, component: &str) -> Slots {
        Slots::new(&self.folder, &file_name_of(component))
    }

    /// Removes all files of components.
    ///
    /// # Errors
    /// The first one that cannot be removed; the others are.
    pub fn clear(&self) -> Result<(), StoreError> {
        let unusable = |error| StoreError::Unusable {
            folder: self.folder.clone(),
            error,
        };
        let mut result = Ok(());
        for entry in std::fs::read_dir(&self.folder).map_err(unusable)? {
            let path = entry.map_err(unusable)?.path();
            if is_of_slots(&path) {
                result = result.and(std::fs::remove_file(&path).map_err(unusable));
            }
        }
        result
    }
}

/// What another user could have put there, or can write to, is not restored.
fn inspect(folder: &Path) -> Result<(), StoreError> {
    let metadata = std::fs::symlink_metadata(folder).map_err(|error| StoreError::Unusable {
        folder: folder.to_owned(),
        error,
    })?;
    let reason = if !metadata.is_dir() {
        "it is a link".to_owned()
    } else if metadata.uid() != geteuid().as_raw() {
        format!("it belongs to user {}", metadata.uid())
    } else if metadata.mode() & WRITABLE_BY_OTHERS != 0 {
        format!(
            "others can write to it (mode {:o})",
            metadata.mode() & 0o777
        )
    } else {
        return Ok(());
    };
    Err(StoreError::NotOurs {
        folder: folder.to_owned(),
        reason,
    })
}

/// The name as a file: letters, digits, `_` and `-` stay, other bytes are written `%20`; of a long
/// one the end is replaced by its checksum. Different names give different files.
fn file_name_of(name: &str) -> String {
    let mut written = String::new();
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-') {
            written.push(char::from(byte));
        } else {
            written += &format!("%{byte:02X}");
        }
    }
    if written.len() > LONGEST_NAME_BYTES {
        let checksum = super::record::LibraryIdentity::of(String::new(), name.as_bytes()).checksum;
        written.truncate(LONGEST_NAME_BYTES);
        written += &format!("%{checksum:08X}");
    }
    written
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::{PermissionsExt as _, symlink};

    use super::*;

    #[test]
    fn the_first_that_says_where_counts() {
        let found = |asked: Option<&str>, variables: &[(&str, &str)]| {
            let lookup = |name: &str| {
                let found = variables.iter().find(|(other, _)| *other == name);
                found.map(|(_, value)| OsString::from(value))
            };
            let folder = base_folder(asked.map(Path::new), lookup);
            folder.map(|it| it.display().to_string()).ok()
        };
        let all = [
            ("STATE_DIRECTORY", "/var/lib/robot:/var/lib/other"),
            ("XDG_STATE_HOME", "/home/robot/state"),
            ("HOME", "/home/robot"),
        ];
        for (asked, variables, expected) in [
            (Some("here"), &all[..], Some("here")),
            (None, &all[..], Some("/var/lib/robot")),
            (None, &all[1..], Some("/home/robot/state/steadfast")),
            (None, &all[2..], Some("/home/robot/.local/state/steadfast")),
            (None, &[("XDG_STATE_HOME", "relative")], None),
            (None, &[("HOME", "")], None),
        ] {
            let expected = expected.map(str::to_owned);
            assert_eq!(found(asked, variables), expected, "{asked:?} {variables:?}");
        }
    }

    #[test]
    fn names_of_files_stay_inside_and_differ() {
        for (name, expected) in [
            ("left_camera-2", "left_camera-2"),
            ("../a b", "%2E%2E%2Fa%20b"),
            ("글", "%EA%B8%80"),
            ("", ""),
        ] {
            assert_eq!(file_name_of(name), expected);
        }
        let [one, other] = ["x", "y"].map(|end| file_name_of(&("n".repeat(300) + end)));
        assert!(one != other && one.len() < 220, "{one}");
    }

    #[test]
    fn one_container_at_a_time() {
        let base = tempfile::tempdir().unwrap();
        let store = Store::open(base.path(), "patrol").unwrap();
        let mode = std::fs::metadata(&store.folder).unwrap().mode();
        assert_eq!(mode & 0o777, 0o700);
        let refusal = Store::open(base.path(), "patrol").unwrap_err();
        assert!(matches!(refusal, StoreError::InUse(_)), "{refusal}");
        Store::open(base.path(), "mapping").unwrap();
        drop(store);
        Store::open(base.path(), "patrol").unwrap();
    }

    #[test]
    fn only_files_of_components_are_removed() {
        let base = tempfile::tempdir().unwrap();
        let store = Store::open(base.path(), "patrol").unwrap();
        let files = ["camera.a", "camera.b", "camera.new", "notes.txt"];
        let files = files.map(|name| store.folder.join(name));
        for file in &files {
            std::fs::write(file, "").unwrap();
        }
        store.clear().unwrap();
        assert_eq!(files.map(|file| file.exists()), [false, false, false, true]);
    }

    #[test]
    fn a_folder_that_others_may_write_to_is_refused() {
        let base = tempfile::tempdir().unwrap();
        let folder = base.path().join("patrol");
        let refusal = || Store::open(base.path(), "patrol").unwrap_err().to_string();
        symlink(base.path(), &folder).unwrap();
        assert!(refusal().contains("it is a link"), "{}", refusal());
        std::fs::remove_file(&folder).unwrap();
        std::fs::create_dir(&folder).unwrap();
        for mode in [0o770, 0o702] {
            std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(mode)).unwrap();
            let expected = format!("others can write to it (mode {mode:o})");
            assert!(refusal().contains(&expected), "{}", refusal());
        }
    }
}
