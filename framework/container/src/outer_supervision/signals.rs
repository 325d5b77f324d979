//! The signals by which a person or a service manager asks for an ordered stop.

use std::io::{self, Read as _};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;

use rustix::process::Signal;
use signal_hook::consts::{SIGINT, SIGTERM};

/// Two signals, each with the stream on which its arrivals can be read.
#[derive(Debug)]
pub(super) struct Signals([(Signal, UnixStream); 2]);

impl Signals {
    /// From now on they do not end this process.
    pub(super) fn watch() -> io::Result<Self> {
        let watch = |number, signal| -> io::Result<(Signal, UnixStream)> {
            let (read, write) = UnixStream::pair()?;
            read.set_nonblocking(true)?;
            signal_hook::low_level::pipe::register(number, write)?;
            Ok((signal, read))
        };
        Ok(Self([
            watch(SIGINT, Signal::INT)?,
            watch(SIGTERM, Signal::TERM)?,
        ]))
    }

    /// What is readable when one has arrived.
    pub(super) fn descriptors(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        self.0.iter().map(|(_, stream)| stream.as_fd())
    }

    /// Those that have arrived, each as often as it has. More than two of one change nothing.
    pub(super) fn take(&self) -> Vec<Signal> {
        let mut arrived = Vec::new();
        for (signal, stream) in &self.0 {
            let mut buffer = [0; 2];
            let mut stream = stream;
            let count = stream.read(&mut buffer).unwrap_or(0);
            arrived.extend(std::iter::repeat_n(*signal, count));
        }
        arrived
    }
}
