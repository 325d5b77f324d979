//! The folder of a black box: its files by number, and only so many bytes of them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use recording::WriteError;

/// What the names of its files begin and end with; all others are left alone.
const PREFIX: &str = "blackbox-";
const SUFFIX: &str = ".mcap";

/// The folder.
#[derive(Debug)]
pub(super) struct Folder {
    path: PathBuf,
    /// The number of the next file.
    next: u64,
}

impl Folder {
    /// Opens the folder, or makes it; goes on behind the files of earlier runs.
    pub(super) fn open(path: &Path) -> Result<Self, WriteError> {
        let files = fs::create_dir_all(path).and_then(|()| files(path));
        let files = files.map_err(|error| refused(path, &error))?;
        Ok(Self {
            path: path.to_owned(),
            next: files.last().map_or(1, |(number, _, _)| number + 1),
        })
    }

    /// The path of a new file, after the oldest files were removed until the others have at most so
    /// many bytes.
    pub(super) fn next(&mut self, title: &str, most_bytes: u64) -> Result<PathBuf, WriteError> {
        self.make_room(most_bytes)
            .map_err(|error| refused(&self.path, &error))?;
        let number = self.next;
        self.next += 1;
        // With several applications a component's name has a slash.
        let title: String = title
            .chars()
            .map(|it| if it.is_alphanumeric() { it } else { '_' })
            .collect();
        Ok(self
            .path
            .join(format!("{PREFIX}{number:06}-{title}{SUFFIX}")))
    }

    fn make_room(&self, most_bytes: u64) -> io::Result<()> {
        let files = files(&self.path)?;
        let mut bytes: u64 = files.iter().map(|(_, length, _)| length).sum();
        for (_, length, path) in files {
            if bytes <= most_bytes {
                break;
            }
            fs::remove_file(path)?;
            bytes -= length;
        }
        Ok(())
    }
}

/// Number, length and path of its files, by number.
fn files(folder: &Path) -> io::Result<Vec<(u64, u64, PathBuf)>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let number = name
            .to_str()
            .filter(|name| name.ends_with(SUFFIX))
            .and_then(|name| name.strip_prefix(PREFIX)?.split('-').next()?.parse().ok());
        if let Some(number) = number {
            files.push((number, entry.metadata()?.len(), entry.path()));
        }
    }
    files.sort();
    Ok(files)
}

fn refused(path: &Path, error: &io::Error) -> WriteError {
    WriteError {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_make_room_and_strangers_stay() {
        let folder = tempfile::tempdir().unwrap();
        let stranger = folder.path().join("blackbox.mcap");
        fs::write(&stranger, [0; 1000]).unwrap();
        let mut box_folder = Folder::open(folder.path()).unwrap();
        for number in 1..=12 {
            let path = box_folder.next("robot/camera-hang", 350).unwrap();
            let name = format!("blackbox-{number:06}-robot_camera_hang.mcap");
            assert_eq!(path, folder.path().join(name));
            fs::write(path, [0; 100]).unwrap();
        }
        let numbers = |folder: &Path| {
            let files = files(folder).unwrap().into_iter();
            files.map(|(number, _, _)| number).collect::<Vec<_>>()
        };
        assert_eq!(numbers(folder.path()), [9, 10, 11, 12]);
        assert!(stranger.exists());
        let mut again = Folder::open(folder.path()).unwrap();
        again.next("x", 0).unwrap();
        assert_eq!((numbers(folder.path()), again.next), (vec![], 14));
    }
}
