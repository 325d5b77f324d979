//! In place of the server for Foxglove where `steadfast` was built without it.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use super::record_file::{Entry, RecordedPort};

/// There is none.
#[derive(Debug)]
pub(super) enum LiveServer {}

impl LiveServer {
    /// Says what is missing.
    pub(super) fn start(_address: SocketAddr, _ports: Arc<[RecordedPort]>) -> io::Result<Self> {
        Err(io::Error::other(
            "--foxglove: this steadfast was built without it\n  help: build it by 'cargo build \
             --release --features container/foxglove', or use --record and open the file",
        ))
    }

    pub(super) fn address(&self) -> SocketAddr {
        match *self {}
    }

    pub(super) fn write(&mut self, _entry: &Entry<'_>) {
        match *self {}
    }
}
