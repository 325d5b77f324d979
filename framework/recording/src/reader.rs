//! A recording read back, one message after the other, in bounded memory.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::McapError;
use mcap::records::{self, Record};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use serde_json::Value;

use crate::channel::Channel;
use crate::error::ReadError;

/// No chunk or message of ours is nearly as long; a length beyond is damage, not data.
const LONGEST_RECORD_BYTES: usize = 256 << 20;

/// One message.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Where it belongs.
    pub channel: Arc<Channel>,
    /// When it was seen, in nanoseconds of the container's clock.
    pub t_ns: u64,
    /// When its sender wrote it.
    pub publish_ns: u64,
    /// What it says.
    pub value: Value,
}

impl Message {
    /// Its topic.
    pub fn topic(&self) -> &str {
        &self.channel.topic
    }
}

/// The messages of a file, in the order in which they were written; of one run that is the order of
/// time. A file that was cut off ends where it was cut.
pub struct Reader {
    path: PathBuf,
    file: File,
    reader: LinearReader,
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, (Arc<Channel>, String)>,
    about: BTreeMap<String, String>,
    messages: u64,
    was_cut: bool,
    ended: bool,
}

/// Opens a recording.
///
/// # Errors
/// If it cannot be opened, or does not begin as an MCAP file does.
pub fn read(path: &Path) -> Result<Reader, ReadError> {
    let file = File::open(path).map_err(|error| ReadError::File {
        path: path.to_owned(),
        error,
    })?;
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(LONGEST_RECORD_BYTES);
    Ok(Reader {
        path: path.to_owned(),
        file,
        reader: LinearReader::new_with_options(options),
        schemas: BTreeMap::new(),
        channels: BTreeMap::new(),
        about: BTreeMap::new(),
        messages: 0,
        was_cut: false,
        ended: false,
    })
}

/// What a step has brought.
enum Step {
    /// The file wants to be read on, by so many bytes.
    More(usize),
    /// A message of this channel.
    Message(records::MessageHeader, Vec<u8>),
    /// Something else.
    Nothing,
}

impl Reader {
    /// Whether the file ends before its end: its process died, or it is still being written. Known
    /// when the last message has been read.
    pub fn was_cut(&self) -> bool {
        self.was_cut
    }

    /// What the file says of its run. Known when the first message has been read.
    pub fn about(&self) -> &BTreeMap<String, String> {
        &self.about
    }

    /// The channels that are known so far: in files of steadfast all of them, when the first message
    /// has been read.
    pub fn channels(&self) -> Vec<Arc<Channel>> {
        let channels = self.channels.values();
        channels.map(|(channel, _)| Arc::clone(channel)).collect()
    }

    /// The next message of a wanted topic. The others are not decoded, which is most of the work with
    /// a camera's.
    pub fn next_of(
        &mut self,
        mut is_wanted: impl FnMut(&str) -> bool,
    ) -> Option<Result<Message, ReadError>> {
        let next = self.advance(&mut is_wanted).transpose();
        self.ended |= matches!(next, Some(Err(_)));
        next
    }

    fn advance(
        &mut self,
        is_wanted: &mut dyn FnMut(&str) -> bool,
    ) -> Result<Option<Message>, ReadError> {
        while !self.ended {
            let step = match self.reader.next_event() {
                None => break,
                Some(Ok(LinearReadEvent::ReadRequest(bytes))) => Ok(Step::More(bytes)),
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    mcap::parse_record(opcode, data).map(|record| {
                        keep(
                            record,
                            &mut self.schemas,
                            &mut self.channels,
                            &mut self.about,
                        )
                    })
                }
                Some(Err(McapError::UnexpectedEof)) => {
                    self.was_cut = true;
                    break;
                }
                Some(Err(error)) => Err(error),
            };
            match step.map_err(|error| self.damaged(&error))? {
                Step::More(bytes) => self.fill(bytes)?,
                Step::Message(header, data) => {
                    let channel = self.channels.get(&header.channel_id);
                    if channel.is_none_or(|(channel, _)| is_wanted(&channel.topic)) {
                        return self.message(&header, &data).map(Some);
                    }
                }
                Step::Nothing => {}
            }
        }
        self.ended = true;
        Ok(None)
    }

    fn fill(&mut self, bytes: usize) -> Result<(), ReadError> {
        let read = self.file.read(self.reader.insert(bytes));
        let read = read.map_err(|error| ReadError::File {
            path: self.path.clone(),
            error,
        })?;
        self.reader.notify_read(read);
        Ok(())
    }

    fn message(
        &mut self,
        header: &records::MessageHeader,
        data: &[u8],
    ) -> Result<Message, ReadError> {
        let Some((channel, encoding)) = self.channels.get(&header.channel_id) else {
            let unknown = McapError::UnknownChannel(header.sequence, header.channel_id);
            return Err(self.damaged(&unknown));
        };
        if encoding != "json" {
            return Err(ReadError::Encoding {
                path: self.path.clone(),
                topic: channel.topic.clone(),
                encoding: encoding.clone(),
            });
        }
        let value = serde_json::from_slice(data).map_err(|error| ReadError::Damaged {
            path: self.path.clone(),
            messages: self.messages,
            reason: format!("a message of '{}' is no JSON: {error}", channel.topic),
        })?;
        self.messages += 1;
        Ok(Message {
            channel: Arc::clone(channel),
            t_ns: header.log_time,
            publish_ns: header.publish_time,
            value,
        })
    }

    fn damaged(&self, error: &McapError) -> ReadError {
        ReadError::Damaged {
            path: self.path.clone(),
            messages: self.messages,
            reason: error.to_string(),
        }
    }
}

impl Iterator for Reader {
    type Item = Result<Message, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_of(|_topic| true)
    }
}

/// Keeps what later messages refer to.
fn keep(
    record: Record<'_>,
    schemas: &mut BTreeMap<u16, String>,
    channels: &mut BTreeMap<u16, (Arc<Channel>, String)>,
    about: &mut BTreeMap<String, String>,
) -> Step {
    match record {
        Record::Message { header, data } => return Step::Message(header, data.into_owned()),
        Record::Schema { header, .. } => {
            schemas.insert(header.id, header.name);
        }
        Record::Channel(channel) => {
            let schema = schemas.get(&channel.schema_id).cloned();
            let known = Channel {
                topic: channel.topic,
                schema: schema.unwrap_or_default(),
                metadata: channel.metadata,
            };
            channels.insert(channel.id, (Arc::new(known), channel.message_encoding));
        }
        Record::Metadata(metadata) if metadata.name == "steadfast" => *about = metadata.metadata,
        _ => {}
    }
    Step::Nothing
}

#[cfg(test)]
mod tests;
