//! An event file, line by line.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;

use super::{refused, unreadable};
use crate::commands::report::gathering::Gathering;
use crate::commands::run::Failed;

/// An event with a long backtrace has some ten kilobytes. What is longer is another kind of file.
const LONGEST_LINE: u64 = 1 << 20;

/// What to do about a file that is none.
const HELP: &str = "name a file that `steadfast run --events` or `--record` wrote";

/// Reads a run. The half line that a container leaves when it is killed is passed over.
pub(super) fn read(path: &Path) -> Result<Gathering, Failed> {
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    let mut lines = BufReader::new(file);
    let mut gathering = Gathering::new(path.display().to_string());
    let mut line = Vec::new();
    for number in 1u64.. {
        line.clear();
        let read = lines
            .by_ref()
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line);
        if read.map_err(|error| unreadable(path, &error))? == 0 {
            break;
        }
        let learned = serde_json::from_slice(&line)
            .map_err(|error| format!("it is no JSON: {error}"))
            .and_then(|event| gathering.learn(&event));
        let is_half = !line.ends_with(b"\n") && (line.len() as u64) < LONGEST_LINE;
        match learned {
            Ok(()) => {}
            Err(_unfinished) if is_half && number > 1 => break,
            Err(error) => {
                let what = format!("has no event in line {number}: {error}");
                return Err(refused(path, &what, HELP));
            }
        }
    }
    match gathering.run.span_ns {
        Some(_) => Ok(gathering),
        None => Err(refused(path, "has no event in it", HELP)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_events_and_others() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("events.jsonl");
        let event = r#"{"t_ns":7,"event":"notice","message":"a"}"#;
        let long = "x".repeat(2 << 20);
        for (content, expected) in [
            (format!("{event}\n{event}\n"), Ok(2)),
            (format!("{event}\n{event}"), Ok(2)),
            (format!("{event}\n{{\"t_ns\":8,\"ev"), Ok(1)),
            (format!("{event}\nnonsense\n{event}\n"), Err("line 2")),
            ("<svg/>".to_owned(), Err("line 1")),
            ("{\"name\": 7}\n".to_owned(), Err("line 1")),
            (String::new(), Err("no event in it")),
            (format!("{event}\n{long}"), Err("line 2")),
        ] {
            std::fs::write(&path, &content).expect("a file");
            match (read(&path), expected) {
                (Ok(gathering), Ok(count)) => assert_eq!(gathering.run.incidents.len(), count),
                (Err(failed), Err(words)) => {
                    assert!(failed.text.contains(words), "{}", failed.text)
                }
                (found, _) => panic!("{expected:?}, {:?}", found.map_err(|it| it.text)),
            }
        }
    }
}
