//! An event file that a container which died has left.

use std::fs::{File, OpenOptions};
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;

/// What is looked through at once for the end of a line: longer than all but the longest verdicts.
const CHUNK_BYTES: u64 = 4096;

/// Opens the file for lines after its last whole one; makes it if need be.
pub(super) fn open_at_end(path: &Path) -> io::Result<File> {
    let mut file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)?;
    let end = end_of_last_line(&mut file)?;
    file.set_len(end)?;
    file.seek(SeekFrom::Start(end))?;
    Ok(file)
}

fn end_of_last_line(file: &mut File) -> io::Result<u64> {
    let mut end = file.metadata()?.len();
    while end > 0 {
        let start = end.saturating_sub(CHUNK_BYTES);
        let mut chunk = Vec::new();
        file.seek(SeekFrom::Start(start))?;
        file.by_ref().take(end - start).read_to_end(&mut chunk)?;
        if let Some(index) = chunk.iter().rposition(|byte| *byte == b'\n') {
            return Ok(start + index as u64 + 1);
        }
        end = start;
    }
    Ok(0)
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    #[test]
    fn half_a_line_makes_room_for_the_next() {
        let long = "l".repeat(3 * CHUNK_BYTES as usize);
        for (left, kept) in [
            (String::new(), String::new()),
            ("one\n".to_owned(), "one\n".to_owned()),
            ("one\ntwo\nhal".to_owned(), "one\ntwo\n".to_owned()),
            ("hal".to_owned(), String::new()),
            (format!("one\n{long}"), "one\n".to_owned()),
            (format!("{long}\n"), format!("{long}\n")),
            (long.clone(), String::new()),
        ] {
            let file = tempfile::NamedTempFile::new().unwrap();
            std::fs::write(file.path(), &left).unwrap();
            open_at_end(file.path())
                .unwrap()
                .write_all(b"next\n")
                .unwrap();
            let now = std::fs::read_to_string(file.path()).unwrap();
            assert_eq!(now, kept + "next\n");
        }
    }

    #[test]
    fn a_file_that_is_not_there_is_made() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        open_at_end(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"");
    }
}
