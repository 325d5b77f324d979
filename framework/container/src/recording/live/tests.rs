//! A plain WebSocket client negotiates, subscribes, and gets what was written.

use std::io::{Read as _, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use recording::Layout;
use serde_json::json;
use system_model::data_type::{DataType, Field, Scalar};

use super::*;

/// Longer than anything here takes.
const PATIENCE: Duration = Duration::from_secs(20);

/// As little of RFC 6455 as it takes.
struct Client(TcpStream);

impl Client {
    fn connect(address: SocketAddr) -> Self {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let request = format!(
            "GET / HTTP/1.1\r\nHost: {address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\
             Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n"
        );
        stream.write_all(request.as_bytes()).unwrap();
        let mut head = Vec::new();
        while !head.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            head.push(byte[0]);
        }
        let head = String::from_utf8(head).unwrap().to_lowercase();
        assert!(head.starts_with("http/1.1 101"), "{head}");
        assert!(
            head.contains("sec-websocket-accept: s3pplmbitxaq9kygzzhzrbk+xoo="),
            "{head}"
        );
        assert!(
            head.contains("sec-websocket-protocol: foxglove.sdk.v1"),
            "{head}"
        );
        Self(stream)
    }

    /// Sends a text of less than 126 bytes, masked with zeros, as a client must.
    fn say(&mut self, message: &Value) {
        let text = message.to_string();
        let length = u8::try_from(text.len()).unwrap();
        assert!(length < 126);
        let mut frame = vec![0x81, 0x80 | length, 0, 0, 0, 0];
        frame.extend_from_slice(text.as_bytes());
        self.0.write_all(&frame).unwrap();
    }

    /// The next message, and whether it is binary.
    fn hear(&mut self) -> (bool, Vec<u8>) {
        loop {
            let mut head = [0; 2];
            self.0.read_exact(&mut head).unwrap();
            let mut length = u64::from(head[1] & 0x7f);
            if length == 126 {
                let mut long = [0; 2];
                self.0.read_exact(&mut long).unwrap();
                length = u64::from(u16::from_be_bytes(long));
            } else if length == 127 {
                let mut long = [0; 8];
                self.0.read_exact(&mut long).unwrap();
                length = u64::from_be_bytes(long);
            }
            let mut content = vec![0; usize::try_from(length).unwrap()];
            self.0.read_exact(&mut content).unwrap();
            match head[0] & 0x0f {
                1 => return (false, content),
                2 => return (true, content),
                _ping_or_pong => {}
            }
        }
    }

    /// The next text of this operation.
    fn hear_of(&mut self, operation: &str) -> Value {
        loop {
            let (is_binary, content) = self.hear();
            let message: Value = match is_binary {
                true => continue,
                false => serde_json::from_slice(&content).unwrap(),
            };
            if message["op"] == operation {
                return message;
            }
        }
    }

    /// The next message of a subscription: number of that, time, content.
    fn message(&mut self) -> (u32, u64, Value) {
        loop {
            let (is_binary, content) = self.hear();
            if is_binary && content[0] == 1 {
                return (
                    u32::from_le_bytes(content[1..5].try_into().unwrap()),
                    u64::from_le_bytes(content[5..13].try_into().unwrap()),
                    serde_json::from_slice(&content[13..]).unwrap(),
                );
            }
        }
    }
}

fn ports() -> Arc<[RecordedPort]> {
    let data_type = DataType {
        name: "Range".to_owned(),
        size: 8,
        layout_hash: 0,
        fields: vec![Field {
            path: "distance".to_owned(),
            unit: "m".to_owned(),
            offset: 0,
            scalar: Scalar::F64,
            count: 1,
        }],
    };
    Arc::from([RecordedPort {
        component: "sonar".to_owned(),
        port: "range".to_owned(),
        direction: "output",
        layout: Layout::new(&data_type),
    }])
}

#[test]
fn a_client_negotiates_subscribes_and_gets_messages() {
    let mut server = LiveServer::start((Ipv4Addr::LOCALHOST, 0).into(), ports()).unwrap();
    let mut client = Client::connect(server.address());
    assert_eq!(client.hear_of("serverInfo")["name"], "steadfast");
    let mut channels = Vec::new();
    while channels.len() < 5 {
        let advertised = client.hear_of("advertise");
        channels.extend(advertised["channels"].as_array().unwrap().clone());
    }
    let channel = |topic: &str| {
        let found = channels.iter().find(|channel| channel["topic"] == topic);
        found
            .unwrap_or_else(|| panic!("no {topic} in {channels:?}"))
            .clone()
    };
    let range = channel("/sonar/range");
    assert_eq!(
        (&range["encoding"], &range["schemaName"]),
        (&json!("json"), &json!("Range"))
    );
    let schema: Value = serde_json::from_str(range["schema"].as_str().unwrap()).unwrap();
    assert!(schema["properties"]["distance"].is_object(), "{schema}");
    for (id, topic) in [(1, "/sonar/range"), (2, "/diagnostics")] {
        let number = channel(topic)["id"].clone();
        let subscriptions = json!([{"id": id, "channelId": number}]);
        client.say(&json!({"op": "subscribe", "subscriptions": subscriptions}));
    }
    let subscribed = Instant::now();
    while !(server.channels[0].has_sinks() && server.topics[&Topic::Diagnostics].has_sinks()) {
        assert!(
            subscribed.elapsed() < PATIENCE,
            "the server hears of no subscription"
        );
        std::thread::yield_now();
    }
    let entry = |source, log_ns, content| Entry {
        source,
        log_ns,
        publish_ns: log_ns,
        content,
    };
    let distance = 1.5_f64.to_ne_bytes();
    server.write(&entry(Source::Port(0), 7, &distance));
    server.write(&entry(Source::Topic(Topic::Events), 8, b"{}"));
    server.write(&entry(
        Source::Topic(Topic::Diagnostics),
        9,
        b"{\"status\":[]}",
    ));
    assert_eq!(client.message(), (1, 7, json!({"distance": 1.5})));
    assert_eq!(client.message(), (2, 9, json!({"status": []})));
}

#[test]
fn an_address_that_is_taken_is_refused_in_words() {
    let taken = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let address = taken.local_addr().unwrap();
    let error = LiveServer::start(address, ports()).unwrap_err().to_string();
    assert!(
        error.contains(&address.to_string()) && error.contains("help:"),
        "{error}"
    );
}
