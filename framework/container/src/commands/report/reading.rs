//! Files of runs: which of them tell of the same run, and what they tell.

mod event_file;
mod recording_file;

use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use super::gathering::Gathering;
use super::model::{Run, Summary};
use crate::commands::exit_code;
use crate::commands::run::Failed;
use recording_file::Recording;

/// How an MCAP file begins.
const MCAP_MAGIC: [u8; 5] = [0x89, b'M', b'C', b'A', b'P'];

/// A picture that is longer makes a page that opens slowly; that of a drive of ten minutes has a
/// megabyte.
const LONGEST_PICTURE: u64 = 8 << 20;

/// Reads runs: event files first, each a run; then recordings, which belong to the run that has told
/// of all their events, or are one of their own.
///
/// # Errors
/// If a file cannot be read, or is none of these.
pub(super) fn read(paths: &[PathBuf]) -> Result<Vec<Run>, Failed> {
    let mut runs: Vec<(Gathering, Vec<Recording>)> = Vec::new();
    let mut recordings = Vec::new();
    for path in paths {
        match is_recording(path)? {
            true => recordings.push(path),
            false => runs.push((event_file::read(path)?, Vec::new())),
        }
    }
    for path in recordings {
        let known: Vec<&Gathering> = runs.iter().map(|(gathering, _)| gathering).collect();
        match recording_file::run_of(path, &known)? {
            Some((index, recording)) => {
                let (gathering, recordings) = &mut runs[index];
                gathering.run.sources.push(path.display().to_string());
                recordings.push(recording);
            }
            None => {
                let (gathering, recording) = recording_file::read(path)?;
                runs.push((gathering, vec![recording]));
            }
        }
    }
    let runs = runs.into_iter().map(|(gathering, recordings)| {
        let mut run = gathering.finish();
        for recording in recordings {
            recording_file::collect(&recording, &mut run)?;
        }
        Ok(run)
    });
    runs.collect()
}

/// Reads a summary.
///
/// # Errors
/// If it cannot be read, or is none.
pub(super) fn read_summary(path: &Path) -> Result<Summary, Failed> {
    let text = std::fs::read(path).map_err(|error| unreadable(path, &error))?;
    serde_json::from_slice(&text).map_err(|error| {
        let help = "name a file that `steadfast run --summary` wrote";
        refused(path, &format!("is no summary: {error}"), help)
    })
}

/// Reads a picture, as an address that holds all of it.
///
/// # Errors
/// If it cannot be read, or is none.
pub(super) fn read_picture(path: &Path) -> Result<String, Failed> {
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    let mut text = String::new();
    let read = file.take(LONGEST_PICTURE + 1).read_to_string(&mut text);
    let help = "name a file that `steadfast run --picture` wrote";
    read.map_err(|error| match error.kind() {
        io::ErrorKind::InvalidData => refused(path, "is no SVG picture", help),
        _ => unreadable(path, &error),
    })?;
    if text.len() as u64 > LONGEST_PICTURE {
        return Err(refused(
            path,
            "is longer than the 8 MiB that a page has room for",
            help,
        ));
    }
    let begins = text.trim_start();
    if !(begins.starts_with("<svg") || begins.starts_with("<?xml")) {
        return Err(refused(path, "is no SVG picture", help));
    }
    Ok(data_address(&text))
}

/// A picture as an address. A browser shows it as an image: nothing in it is run or loaded.
fn data_address(svg: &str) -> String {
    let mut address = "data:image/svg+xml,".to_owned();
    for byte in svg.bytes() {
        match byte {
            b'%' | b'#' | b'"' | b'\'' | b'<' | b'>' | b'&' | b'\\' | b'`' | 0..=b' ' | 0x7f.. => {
                address += &format!("%{byte:02X}");
            }
            other => address.push(char::from(other)),
        }
    }
    address
}

fn is_recording(path: &Path) -> Result<bool, Failed> {
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    let mut begin = Vec::new();
    let length = MCAP_MAGIC.len() as u64;
    let read = file.take(length).read_to_end(&mut begin);
    read.map_err(|error| unreadable(path, &error))?;
    Ok(begin == MCAP_MAGIC)
}

fn unreadable(path: &Path, error: &io::Error) -> Failed {
    Failed {
        code: exit_code::FILE,
        text: format!(
            "{} cannot be read: {error}\n  help: name what `steadfast run` wrote: --events, \
             --record, --summary or --picture",
            path.display()
        ),
    }
}

fn refused(path: &Path, what: &str, help: &str) -> Failed {
    Failed {
        code: exit_code::REFUSED,
        text: format!("{} {what}\n  help: {help}", path.display()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_nothing_in_it_that_ends_it() {
        let address = data_address("<svg fill=\"#333\">50 % 로봇</svg>");
        assert_eq!(
            address,
            "data:image/svg+xml,%3Csvg%20fill=%22%23333%22%3E50%20%25%20%EB%A1%9C%EB%B4%87%3C/svg%3E"
        );
    }

    #[test]
    fn what_is_no_picture_or_summary_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("drive.svg");
        let code = |path: &Path| read_picture(path).map_err(|it| it.code);
        assert_eq!(code(&path), Err(exit_code::FILE));
        for (content, expected) in [
            (
                &b"<svg/>"[..],
                Ok("data:image/svg+xml,%3Csvg/%3E".to_owned()),
            ),
            (b"{}", Err(exit_code::REFUSED)),
            (b"\xff\xfe<svg/>", Err(exit_code::REFUSED)),
        ] {
            std::fs::write(&path, content).expect("a file");
            assert_eq!(code(&path), expected);
        }
        let summary = read_summary(&path).map_err(|it| it.code);
        assert!(matches!(summary, Err(exit_code::REFUSED)));
    }
}
