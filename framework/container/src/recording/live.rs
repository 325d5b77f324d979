//! A server for Foxglove: what would be written into a recording goes to whoever has subscribed to it,
//! over a WebSocket (subprotocol `foxglove.sdk.v1`). Threads of its own carry it; a client that does not
//! keep up loses the oldest messages.

use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use foxglove::{
    ChannelBuilder, Context, FoxgloveError, PartialMetadata, RawChannel, Schema, WebSocketServer,
    WebSocketServerHandle,
};
use recording::Topic;
use serde_json::Value;

use super::record_file::{Entry, RecordedPort, Source};

/// Messages that may wait for one client: a second of the reference robot's.
const BACKLOG: usize = 1024;

/// The server, until it is dropped.
#[derive(Debug)]
pub(super) struct LiveServer {
    address: SocketAddr,
    server: Option<WebSocketServerHandle>,
    ports: Arc<[RecordedPort]>,
    /// By port.
    channels: Vec<Arc<RawChannel>>,
    topics: BTreeMap<Topic, Arc<RawChannel>>,
    json: Vec<u8>,
    /// Channels are its as long as it is there.
    _context: Arc<Context>,
}

impl LiveServer {
    /// Serves these ports, and the topics that every recording has.
    ///
    /// # Errors
    /// If the address cannot be listened at.
    pub(super) fn start(address: SocketAddr, ports: Arc<[RecordedPort]>) -> io::Result<Self> {
        let context = Context::new();
        let server = WebSocketServer::new()
            .name("steadfast")
            .context(&context)
            .message_backlog_size(BACKLOG)
            .bind(address.ip().to_string(), address.port())
            .start_blocking()
            .map_err(|error| refused(address, &error))?;
        let channels = ports.iter().map(|port| {
            let name = format!("/{}/{}", port.component, port.port);
            let layout = &port.layout;
            let builder = channel(&context, &name, &layout.data_type().name, layout.schema());
            let builder = builder.add_metadata("component", &port.component);
            let builder = builder.add_metadata("port", &port.port);
            builder
                .add_metadata("direction", port.direction)
                .build_raw()
        });
        let channels = channels.collect::<Result<_, _>>();
        let topics = Topic::ALL.into_iter().map(|topic| {
            let builder = channel(&context, topic.name(), topic.schema_name(), &topic.schema());
            Ok((topic, builder.build_raw()?))
        });
        let topics = topics.collect::<Result<_, FoxgloveError>>();
        Ok(Self {
            address: SocketAddr::new(address.ip(), server.port()),
            server: Some(server),
            ports,
            channels: channels.map_err(|error| refused(address, &error))?,
            topics: topics.map_err(|error| refused(address, &error))?,
            json: Vec::new(),
            _context: context,
        })
    }

    /// Where it listens.
    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Sends a message to whoever has subscribed to it; where nobody has it costs nothing.
    pub(super) fn write(&mut self, entry: &Entry<'_>) {
        let time = PartialMetadata {
            log_time: Some(entry.log_ns),
        };
        match entry.source {
            Source::Port(index) if self.channels[index].has_sinks() => {
                self.json.clear();
                let layout = &self.ports[index].layout;
                layout.encode(entry.content, &mut self.json);
                self.channels[index].log_with_meta(&self.json, time);
            }
            Source::Port(_) => {}
            Source::Topic(topic) => {
                if let Some(channel) = self.topics.get(&topic) {
                    channel.log_with_meta(entry.content, time);
                }
            }
        }
    }
}

impl Drop for LiveServer {
    fn drop(&mut self) {
        if let Some(server) = self.server.take() {
            // Its threads end by themselves; a client that hangs is not waited for.
            let _not_waited_for = server.stop();
        }
    }
}

fn channel(context: &Arc<Context>, topic: &str, schema: &str, content: &Value) -> ChannelBuilder {
    let content = content.to_string().into_bytes();
    context
        .channel_builder(topic)
        .message_encoding("json")
        .schema(Schema::new(schema, "jsonschema", content))
}

fn refused(address: SocketAddr, error: &FoxgloveError) -> io::Error {
    io::Error::other(format!(
        "--foxglove: {address} cannot be listened at: {error}\n  help: another process may use it; \
         choose another one by --foxglove=ADDRESS"
    ))
}

#[cfg(test)]
mod tests;
