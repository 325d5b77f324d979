//! A recording that is being prepared: ports are added, then it starts.

use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, bounded};
use recording::{Layout, WriteError};
use system_model::data_type::DataType;

use super::black_box::BlackBox;
use super::diagnosis::Diagnosis;
use super::live::LiveServer;
use super::options::RecordingOptions;
use super::port_recorder::{PortRecorder, Track, ring};
use super::record_file::{RecordFile, RecordedPort};
use super::sinks::Sinks;
use super::thread::RecordingThread;
use crate::component::Environment;
use crate::event_log::Event;
use crate::system::StartError;
use crate::wake::Wake;

/// Events that may wait for the writing thread: as many as for that of the event log.
const EVENT_QUEUE: usize = 8192;

/// A recording that has not started.
pub struct Recorder {
    options: RecordingOptions,
    events: Receiver<(u64, Event)>,
    wake: Arc<Wake>,
    /// Whether full rings make their writers wait.
    waits: bool,
    ports: Vec<RecordedPort>,
    tracks: Vec<Track>,
    left_out: Vec<String>,
}

impl Recorder {
    /// One without ports, and where events go. `waits`: whether nothing may be dropped, because time
    /// is simulated.
    pub fn new(options: RecordingOptions, waits: bool) -> (Self, Sender<(u64, Event)>) {
        let (sender, events) = bounded(EVENT_QUEUE);
        let recorder = Self {
            options,
            events,
            wake: Arc::default(),
            waits,
            ports: Vec::new(),
            tracks: Vec::new(),
            left_out: Vec::new(),
        };
        (recorder, sender)
    }

    /// Adds a port; `direction` is `input`, `output` or `event`, or `monitor` for figures of a process
    /// model. None if its data are too long.
    pub fn port(
        &mut self,
        component: &str,
        port: &str,
        direction: &'static str,
        data_type: &DataType,
    ) -> Option<PortRecorder> {
        let most = self.options.most_bytes_per_datum;
        if data_type.size > most.unwrap_or(RecordingOptions::MOST_BYTES_PER_DATUM) {
            self.left_out.push(format!("/{component}/{port}"));
            return None;
        }
        let waits_for = self.waits.then(|| Arc::clone(&self.wake));
        let (recorder, track) = ring(data_type.size, waits_for);
        self.tracks.push(track);
        self.ports.push(RecordedPort {
            component: component.to_owned(),
            port: port.to_owned(),
            direction,
            layout: Layout::new(data_type),
        });
        Some(recorder)
    }

    /// Ports that are left out, because their data are longer than wanted.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// Makes the file and starts to write. `components`: names, each with that of its application.
    ///
    /// # Errors
    /// If the file cannot be made, or there is no thread.
    pub fn start<'name>(
        self,
        environment: &Arc<Environment>,
        components: impl Iterator<Item = (&'name str, &'name str)>,
        about: Vec<(&'static str, String)>,
    ) -> Result<RecordingThread, StartError> {
        let unwritable = |error: WriteError| StartError::Output {
            path: error.path,
            error: std::io::Error::other(error.reason),
        };
        let ports: Arc<[RecordedPort]> = self.ports.into();
        let path = self.options.file.as_ref();
        let file = path.map(|path| RecordFile::create(path, &about, Arc::clone(&ports)));
        let file = file.transpose().map_err(unwritable)?;
        let options = self.options.black_box;
        let black_box = options.map(|options| BlackBox::new(options, Arc::clone(&ports), about));
        let black_box = black_box.transpose().map_err(unwritable)?;
        let serve = |address| LiveServer::start(address, Arc::clone(&ports));
        let live = self.options.foxglove.map(serve).transpose()?;
        if let Some(live) = &live {
            let message = format!("Foxglove finds this run at ws://{}", live.address());
            let now_ns = environment.clock.now_ns();
            environment.events.record(now_ns, Event::Notice { message });
        }
        let sinks = Sinks::new(file, black_box, live);
        RecordingThread::start(
            Arc::clone(environment),
            self.wake,
            self.tracks,
            ports,
            self.events,
            sinks,
            Diagnosis::new(components),
        )
        .map_err(StartError::from)
    }
}
