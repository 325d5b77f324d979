//! The two files of a component. Each writing replaces the older one as a whole, so whatever happens
//! meanwhile the newer one is still there.

use std::fs::File;
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::record::{LARGEST_MEMORY, Origin, Record, Refusal};

/// Endings of the two files.
const ENDINGS: [&str; 2] = ["a", "b"];

/// Ending of the file that is being written.
const UNFINISHED: &str = "new";

/// More than any file of ours has: the largest memory and three names.
const LARGEST_FILE: u64 = LARGEST_MEMORY as u64 + (1 << 20);

/// The files of one component.
#[derive(Debug)]
pub struct Slots {
    folder: PathBuf,
    files: [PathBuf; 2],
    unfinished: PathBuf,
    /// Which of the two is written next.
    next: usize,
    /// Number of the last writing.
    written: u64,
    /// The content that is being written; kept, so that it has room.
    content: Vec<u8>,
}

/// What is on the disk.
#[derive(Debug)]
pub struct Found {
    /// The newest that may be restored, and how old it is.
    pub fit: Option<(Record, Duration)>,
    /// The others that are newer, or broken.
    pub refused: Vec<RefusedFile>,
}

/// A file that is not restored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("checkpoint {} is refused: {refusal}", .path.display())]
pub struct RefusedFile {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub refusal: Refusal,
}

/// Whether it is a file of any component.
pub(super) fn is_of_slots(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| ENDINGS.contains(&ending) || ending == UNFINISHED)
}

impl Slots {
    /// Those of a component whose files have this name, without a dot in it.
    pub(super) fn new(folder: &Path, name: &str) -> Self {
        let file = |ending: &str| folder.join(format!("{name}.{ending}"));
        Self {
            folder: folder.to_owned(),
            files: ENDINGS.map(file),
            unfinished: file(UNFINISHED),
            next: 0,
            written: 0,
            content: Vec::new(),
        }
    }

    /// Looks for the newest file that may be restored (see [`Record::age_if_fit`]); what is written
    /// from now on replaces the other one.
    pub fn find(
        &mut self,
        expected: &Origin,
        size: Option<usize>,
        now: Duration,
        max_age: Duration,
    ) -> Found {
        let mut found = Found {
            fit: None,
            refused: Vec::new(),
        };
        let mut whole = Vec::new();
        for (slot, path) in self.files.iter().enumerate() {
            match read(path) {
                Ok(None) => {}
                Ok(Some(record)) => whole.push((slot, record)),
                Err(refusal) => found.refused.push(refused(path, refusal)),
            }
        }
        whole.sort_by_key(|(_, record)| record.written);
        self.written = whole.last().map_or(0, |(_, record)| record.written);
        while let Some((slot, record)) = whole.pop() {
            match record.age_if_fit(expected, size, now, max_age) {
                Ok(age) => {
                    self.next = 1 - slot;
                    found.fit = Some((record, age));
                    break;
                }
                Err(refusal) => found.refused.push(refused(&self.files[slot], refusal)),
            }
        }
        found
    }

    /// Writes the record over the older file, as the newest one. When this returns it is on the disk.
    ///
    /// # Errors
    /// If the system refuses; what was there is there still.
    pub fn write(&mut self, record: &mut Record) -> io::Result<()> {
        record.written = self.written + 1;
        record.encode(&mut self.content);
        let mut file = File::create(&self.unfinished)?;
        file.write_all(&self.content)?;
        file.sync_all()?;
        std::fs::rename(&self.unfinished, &self.files[self.next])?;
        File::open(&self.folder)?.sync_all()?;
        self.written = record.written;
        self.next = 1 - self.next;
        Ok(())
    }
}

fn refused(path: &Path, refusal: Refusal) -> RefusedFile {
    RefusedFile {
        path: path.to_owned(),
        refusal,
    }
}

/// A file's record; none if there is no such file.
fn read(path: &Path) -> Result<Option<Record>, Refusal> {
    let unreadable = |error: io::Error| Refusal::Unreadable(error.to_string());
    let file = match File::open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        other => other.map_err(unreadable)?,
    };
    let mut content = Vec::new();
    let mut bounded = file.take(LARGEST_FILE);
    bounded.read_to_end(&mut content).map_err(unreadable)?;
    Record::decode(&content).map(Some)
}

#[cfg(test)]
mod tests;
