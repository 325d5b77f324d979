//! One recording file, with the ports of the system as its channels.

use std::path::Path;
use std::sync::Arc;

use recording::{ChannelId, Layout, RecordingWriter, Topic, WriteError};

/// A port that is recorded.
#[derive(Debug)]
pub(super) struct RecordedPort {
    pub(super) component: String,
    pub(super) port: String,
    pub(super) direction: &'static str,
    pub(super) layout: Layout,
}

/// What a message is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// One of the ports, by its index; the content is the datum as it was.
    Port(usize),
    /// One of the topics that every recording has; the content is JSON.
    Topic(Topic),
}

/// One message on its way into files.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry<'content> {
    pub(super) source: Source,
    pub(super) log_ns: u64,
    pub(super) publish_ns: u64,
    pub(super) content: &'content [u8],
}

/// A file that grows.
#[derive(Debug)]
pub(super) struct RecordFile {
    writer: RecordingWriter,
    ports: Arc<[RecordedPort]>,
    channels: Vec<ChannelId>,
    json: Vec<u8>,
}

impl RecordFile {
    /// Makes the file.
    pub(super) fn create(
        path: &Path,
        about: &[(&str, String)],
        ports: Arc<[RecordedPort]>,
    ) -> Result<Self, WriteError> {
        let mut writer = RecordingWriter::create(path, about)?;
        let channels = ports
            .iter()
            .map(|port| writer.add_port(&port.component, &port.port, port.direction, &port.layout));
        let channels = channels.collect::<Result<_, _>>()?;
        Ok(Self {
            writer,
            ports,
            channels,
            json: Vec::new(),
        })
    }

    /// Writes a message.
    pub(super) fn write(&mut self, entry: &Entry<'_>) -> Result<(), WriteError> {
        let (log_ns, publish_ns) = (entry.log_ns, entry.publish_ns);
        match entry.source {
            Source::Port(index) => {
                self.json.clear();
                self.ports[index]
                    .layout
                    .encode(entry.content, &mut self.json);
                let channel = self.channels[index];
                self.writer.write(channel, log_ns, publish_ns, &self.json)
            }
            Source::Topic(topic) => self.writer.write_json(topic, log_ns, entry.content),
        }
    }

    pub(super) fn writer(&self) -> &RecordingWriter {
        &self.writer
    }

    /// What was written so far can be read whatever happens to this process.
    pub(super) fn flush(&mut self) -> Result<(), WriteError> {
        self.writer.flush()
    }

    pub(super) fn finish(self) -> Result<(), WriteError> {
        self.writer.finish()
    }
}
