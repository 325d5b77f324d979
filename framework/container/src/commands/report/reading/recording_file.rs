//! A recording: its events, and the data around faults.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use recording::{Message, ReadError, Reader, Topic};

use super::refused;
use crate::commands::exit_code;
use crate::commands::report::gathering::Gathering;
use crate::commands::report::model::Run;
use crate::commands::report::signals::{Collector, pose};
use crate::commands::run::Failed;

/// What to do about a file that is none.
const HELP: &str = "name a file that `steadfast run --record` or `--black-box` wrote";

/// A recording that belongs to a run.
#[derive(Debug)]
pub(super) struct Recording {
    path: PathBuf,
    /// The topic that tells where the robot is; empty if none does.
    path_topic: String,
}

/// The run that has told of all events of a recording: its index.
pub(super) fn run_of(
    path: &Path,
    known: &[&Gathering],
) -> Result<Option<(usize, Recording)>, Failed> {
    if known.is_empty() {
        return Ok(None);
    }
    let mut candidates: Vec<usize> = (0..known.len()).collect();
    let mut has_events = false;
    let path_topic = scan(path, |message| {
        has_events = true;
        candidates.retain(|index| known[*index].knows(&message.value));
        Ok(())
    })?;
    let recording = Recording {
        path: path.to_owned(),
        path_topic,
    };
    let index = candidates.first().filter(|_| has_events);
    Ok(index.map(|index| (*index, recording)))
}

/// A run of which only this recording tells.
pub(super) fn read(path: &Path) -> Result<(Gathering, Recording), Failed> {
    let mut gathering = Gathering::new(path.display().to_string());
    let path_topic = scan(path, |message| gathering.learn(&message.value))?;
    if gathering.run.span_ns.is_none() {
        return Err(refused(path, "has no event in it", HELP));
    }
    let recording = Recording {
        path: path.to_owned(),
        path_topic,
    };
    Ok((gathering, recording))
}

/// Takes from a recording what the report of its run shows.
pub(super) fn collect(recording: &Recording, run: &mut Run) -> Result<(), Failed> {
    let mut collector = Collector::new(run, &recording.path_topic);
    let mut reader = open(&recording.path)?;
    let progress = Progress::new(&recording.path);
    while let Some(message) = reader.next_of(|topic| {
        progress.count();
        collector.wants(topic)
    }) {
        let message = message.map_err(|error| unreadable(&error))?;
        collector.take(message.topic(), message.t_ns, &message.value);
    }
    progress.finish();
    collector.finish(run);
    run.recorded = true;
    Ok(())
}

/// Reads the events, and finds the topic that tells where the robot is by one datum of each.
fn scan(
    path: &Path,
    mut learn: impl FnMut(&Message) -> Result<(), String>,
) -> Result<String, Failed> {
    let mut reader = open(path)?;
    let progress = Progress::new(path);
    let events = Topic::Events.name();
    let mut looked_at: HashSet<String> = HashSet::new();
    let mut places: Vec<String> = Vec::new();
    while let Some(message) = reader.next_of(|topic| {
        progress.count();
        topic == events || (!looked_at.contains(topic) && looked_at.insert(topic.to_owned()))
    }) {
        let message = message.map_err(|error| unreadable(&error))?;
        if message.topic() == events {
            learn(&message).map_err(|error| {
                let what = format!("has an event that is none, at {} ns: {error}", message.t_ns);
                refused(path, &what, HELP)
            })?;
        } else if pose(&message.value).is_some() {
            places.push(message.topic().to_owned());
        }
    }
    progress.finish();
    // Which one is as good as another; always the same.
    Ok(places.into_iter().min().unwrap_or_default())
}

fn open(path: &Path) -> Result<Reader, Failed> {
    recording::read(path).map_err(|error| unreadable(&error))
}

fn unreadable(error: &ReadError) -> Failed {
    Failed {
        code: exit_code::FILE,
        text: error.to_string(),
    }
}

/// How far the reading is, for a person at a terminal: a long recording takes seconds.
struct Progress(ProgressBar);

impl Progress {
    fn new(path: &Path) -> Self {
        let bar = ProgressBar::new_spinner();
        bar.set_message(format!("reading {}", path.display()));
        Self(bar)
    }

    /// One more message.
    fn count(&self) {
        self.0.inc(1);
    }

    fn finish(&self) {
        self.0.finish_and_clear();
    }
}

#[cfg(test)]
mod tests;
