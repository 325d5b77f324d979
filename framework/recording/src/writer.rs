//! A recording that grows.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};
use serde::Serialize;
use serde_json::Value;

use crate::channel::Topic;
use crate::error::WriteError;
use crate::layout::Layout;

/// A chunk is what is lost when a file is cut in its middle, and what a reader takes into memory at
/// once: a second and more of a robot without a camera, half a second with one.
const CHUNK_BYTES: u64 = 512 << 10;

/// What is handed to the kernel at once.
const BUFFER_BYTES: usize = 64 << 10;

/// Names a channel of one recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ChannelId(u16);

/// A recording that grows. Dropped without [`Self::finish`] it lacks the index at its end, as if the
/// process had died, and can be read all the same.
pub struct RecordingWriter {
    path: PathBuf,
    writer: Writer<BufWriter<File>>,
    topics: BTreeMap<Topic, u16>,
    sequences: BTreeMap<u16, u32>,
    messages: u64,
    bytes: u64,
}

impl std::fmt::Debug for RecordingWriter {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("RecordingWriter")
            .field("path", &self.path)
            .field("messages", &self.messages)
            .finish_non_exhaustive()
    }
}

impl RecordingWriter {
    /// Makes the file, which must not be in use; one that is there is overwritten. `about`: what a
    /// person may want to know of the run, for the file's metadata.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn create(path: &Path, about: &[(&str, String)]) -> Result<Self, WriteError> {
        let refused = |error: McapError| refused(path, &error);
        let file = File::create(path).map_err(|error| refused(error.into()))?;
        let options = WriteOptions::new()
            .compression(None)
            .profile("")
            .library(concat!("steadfast ", env!("CARGO_PKG_VERSION")))
            .chunk_size(Some(CHUNK_BYTES))
            // A chunk is in the file whole or not at all.
            .disable_seeking(true);
        let file = BufWriter::with_capacity(BUFFER_BYTES, file);
        let mut writer = options.create(file).map_err(refused)?;
        let about = about.iter();
        let metadata = about.map(|(key, value)| ((*key).to_owned(), value.clone()));
        let metadata = Metadata {
            name: "steadfast".to_owned(),
            metadata: metadata.collect(),
        };
        writer.write_metadata(&metadata).map_err(refused)?;
        let mut recording = Self {
            path: path.to_owned(),
            writer,
            topics: BTreeMap::new(),
            sequences: BTreeMap::new(),
            messages: 0,
            bytes: 0,
        };
        for topic in Topic::ALL {
            let nothing = BTreeMap::new();
            let id = recording.add(topic.name(), topic.schema_name(), &topic.schema(), &nothing)?;
            recording.topics.insert(topic, id.0);
        }
        Ok(recording)
    }

    /// Adds a port's channel.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn add_port(
        &mut self,
        component: &str,
        port: &str,
        direction: &str,
        layout: &Layout,
    ) -> Result<ChannelId, WriteError> {
        let data_type = layout.data_type();
        let metadata = [
            ("component", component.to_owned()),
            ("port", port.to_owned()),
            ("direction", direction.to_owned()),
            ("layout_hash", format!("{:#x}", data_type.layout_hash)),
        ];
        let metadata = metadata.map(|(key, value)| (key.to_owned(), value)).into();
        let topic = format!("/{component}/{port}");
        self.add(&topic, &data_type.name, layout.schema(), &metadata)
    }

    /// Writes one message that is JSON already. `log_ns`: when it was seen; `publish_ns`: when it was
    /// written by its sender. Both in nanoseconds of the container's clock.
    ///
    /// # Errors
    /// If the file cannot be written; then nothing more can be.
    pub fn write(
        &mut self,
        channel: ChannelId,
        log_ns: u64,
        publish_ns: u64,
        json: &[u8],
    ) -> Result<(), WriteError> {
        let sequence = self.sequences.entry(channel.0).or_default();
        *sequence = sequence.wrapping_add(1);
        let header = MessageHeader {
            channel_id: channel.0,
            sequence: *sequence,
            log_time: log_ns,
            publish_time: publish_ns,
        };
        let written = self.writer.write_to_known_channel(&header, json);
        written.map_err(|error| refused(&self.path, &error))?;
        self.messages += 1;
        self.bytes += json.len() as u64;
        Ok(())
    }

    /// Writes a message of one of the topics that every recording has.
    ///
    /// # Errors
    /// If the file cannot be written, or the message cannot be JSON.
    pub fn write_topic(
        &mut self,
        topic: Topic,
        time_ns: u64,
        message: &impl Serialize,
    ) -> Result<(), WriteError> {
        let json = serde_json::to_vec(message);
        let json = json.map_err(|error| refused(&self.path, &io::Error::from(error).into()))?;
        self.write_json(topic, time_ns, &json)
    }

    /// As [`Self::write_topic`], of a message that is JSON already.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_json(
        &mut self,
        topic: Topic,
        time_ns: u64,
        json: &[u8],
    ) -> Result<(), WriteError> {
        let channel = ChannelId(self.topics[&topic]);
        self.write(channel, time_ns, time_ns, json)
    }

    /// Messages so far.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// Bytes of messages so far; the file is longer by its indexes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Ends the chunk and hands everything to the kernel: what was written so far can be read even
    /// if this process dies.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        let flushed = self.writer.flush();
        flushed.map_err(|error| refused(&self.path, &error))
    }

    /// Writes the index at the end.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self) -> Result<(), WriteError> {
        let finished = self.writer.finish();
        finished.map_err(|error| refused(&self.path, &error))?;
        self.flush_file()
    }

    fn flush_file(self) -> Result<(), WriteError> {
        let path = self.path;
        let file = self.writer.into_inner().into_inner();
        file.map(drop)
            .map_err(|error| refused(&path, &error.into_error().into()))
    }

    fn add(
        &mut self,
        topic: &str,
        schema_name: &str,
        schema: &Value,
        metadata: &BTreeMap<String, String>,
    ) -> Result<ChannelId, WriteError> {
        let schema = schema.to_string();
        let added = (self.writer)
            .add_schema(schema_name, "jsonschema", schema.as_bytes())
            .and_then(|schema| self.writer.add_channel(schema, topic, "json", metadata));
        added
            .map(ChannelId)
            .map_err(|error| refused(&self.path, &error))
    }
}

fn refused(path: &Path, error: &McapError) -> WriteError {
    let reason = match error {
        McapError::Io(error) => error.to_string(),
        other => other.to_string(),
    };
    WriteError {
        path: path.to_owned(),
        reason,
    }
}
