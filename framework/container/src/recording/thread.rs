//! The thread that writes, as those see it who start and end it.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;

use crossbeam::channel::Receiver;
use serde::Serialize;

use super::diagnosis::Diagnosis;
use super::port_recorder::Track;
use super::record_file::RecordedPort;
use super::sinks::Sinks;
use super::writing::Writing;
use crate::component::Environment;
use crate::event_log::Event;
use crate::wake::Wake;

/// What a recording came to.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct RecordingSummary {
    /// The file of everything, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Messages in it.
    pub messages: u64,
    /// The files of the black box that were begun; older ones may have been removed since.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub black_box: Vec<PathBuf>,
    /// Data that were not recorded, because they came faster than they could be written.
    pub dropped: u64,
    /// The same by topic, for those that lost any.
    pub dropped_by_topic: BTreeMap<String, u64>,
    /// Why it could not be written to its end, if so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// A recording that is under way.
#[derive(Debug)]
pub struct RecordingThread {
    shared: Arc<Shared>,
    wake: Arc<Wake>,
    dropped: Vec<(String, Arc<AtomicU64>)>,
    thread: JoinHandle<RecordingSummary>,
}

/// What the thread is told.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// To come to its end.
    pub(super) stopping: AtomicBool,
}

impl RecordingThread {
    pub(super) fn start(
        environment: Arc<Environment>,
        wake: Arc<Wake>,
        tracks: Vec<Track>,
        ports: Arc<[RecordedPort]>,
        events: Receiver<(u64, Event)>,
        sinks: Sinks,
        diagnosis: Diagnosis,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let topics = ports
            .iter()
            .map(|port| format!("/{}/{}", port.component, port.port));
        let counters = tracks.iter().map(|track| Arc::clone(track.dropped()));
        let dropped: Vec<_> = topics.zip(counters).collect();
        let writing = Writing::new(environment, tracks, events, sinks, diagnosis);
        let (asked, woken) = (Arc::clone(&shared), Arc::clone(&wake));
        let thread = std::thread::Builder::new()
            .name("recording".to_owned())
            .spawn(move || writing.run(&asked, &woken))?;
        Ok(Self {
            shared,
            wake,
            dropped,
            thread,
        })
    }

    /// Data that were not recorded so far.
    pub fn dropped(&self) -> u64 {
        self.dropped_by_topic().values().sum()
    }

    fn dropped_by_topic(&self) -> BTreeMap<String, u64> {
        let all = self.dropped.iter();
        let all = all.map(|(topic, count)| (topic.clone(), count.load(Ordering::Relaxed)));
        all.filter(|(_, count)| *count > 0).collect()
    }

    /// Writes what has come so far and ends the files.
    pub fn finish(self) -> RecordingSummary {
        self.shared.stopping.store(true, Ordering::Release);
        self.wake.wake();
        let dropped_by_topic = self.dropped_by_topic();
        let panicked = |_panic| RecordingSummary {
            failure: Some("the recording's thread panicked".to_owned()),
            ..RecordingSummary::default()
        };
        RecordingSummary {
            dropped: dropped_by_topic.values().sum(),
            dropped_by_topic,
            ..self.thread.join().unwrap_or_else(panicked)
        }
    }
}
