//! Lines of JSON between two processes, each with a descriptor along if need be: what the parent of
//! a supervised container, the container and the process of the simulated world say to each other.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, IoSlice, IoSliceMut};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use rustix::net::{
    RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SendAncillaryBuffer,
    SendAncillaryMessage, SendFlags, recvmsg, sendmsg,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// A longer line is a mistake: the picture of a drive of half an hour has 1 MB.
const MAX_LINE_BYTES: usize = 16 << 20;

/// What is read at once: any line but a picture.
const CHUNK_BYTES: usize = 4096;

/// One end of a line.
#[derive(Debug)]
pub struct DescriptorLine {
    stream: UnixStream,
    /// What has come of the next line.
    unread: Vec<u8>,
    /// Descriptors that have come: the kernel may hand one over with the line before its own.
    descriptors: VecDeque<OwnedFd>,
}

/// What stands in a line.
#[derive(Serialize, Deserialize)]
struct Content<T> {
    /// Whether a descriptor comes along.
    descriptor: bool,
    message: T,
}

impl DescriptorLine {
    /// The end of a line that this stream is; reading and writing give up after `limit`.
    ///
    /// # Errors
    /// If the system refuses the deadline.
    pub fn new(stream: UnixStream, limit: Duration) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_read_timeout(Some(limit))?;
        stream.set_write_timeout(Some(limit))?;
        Ok(Self {
            stream,
            unread: Vec::new(),
            descriptors: VecDeque::new(),
        })
    }

    /// Sends a message, with a descriptor or without.
    ///
    /// # Errors
    /// If the other end is gone, or has not read for too long: then the line is of no use any more.
    pub fn send(
        &mut self,
        message: &impl Serialize,
        descriptor: Option<BorrowedFd<'_>>,
    ) -> io::Result<()> {
        let mut bytes = serde_json::to_vec(&Content {
            descriptor: descriptor.is_some(),
            message,
        })?;
        bytes.push(b'\n');
        let descriptors: Vec<BorrowedFd<'_>> = descriptor.into_iter().collect();
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
        let mut along = SendAncillaryBuffer::new(&mut space);
        if !descriptors.is_empty() {
            along.push(SendAncillaryMessage::ScmRights(&descriptors));
        }
        let mut sent = 0;
        while sent < bytes.len() {
            let parts = [IoSlice::new(&bytes[sent..])];
            match sendmsg(&self.stream, &parts, &mut along, SendFlags::NOSIGNAL) {
                Ok(count) => sent += count,
                Err(rustix::io::Errno::INTR) => continue,
                Err(error) => return Err(error.into()),
            }
            // It has gone with the first bytes.
            along.clear();
        }
        Ok(())
    }

    /// The next message, with the descriptor that came along; none if the other end has closed.
    ///
    /// # Errors
    /// If nothing comes in time, or what comes is no message: then the line is of no use any more.
    pub fn receive<T: DeserializeOwned>(&mut self) -> io::Result<Option<(T, Option<OwnedFd>)>> {
        loop {
            if let Some(end) = self.unread.iter().position(|byte| *byte == b'\n') {
                let content: Content<T> = serde_json::from_slice(&self.unread[..end])?;
                self.unread.drain(..=end);
                let descriptor = match content.descriptor {
                    true => Some(self.descriptors.pop_front().ok_or(ErrorKind::InvalidData)?),
                    false => None,
                };
                return Ok(Some((content.message, descriptor)));
            }
            if self.unread.len() > MAX_LINE_BYTES {
                return Err(io::Error::new(ErrorKind::InvalidData, "a line without end"));
            }
            if self.read_on()? == 0 {
                return Ok(None);
            }
        }
    }

    fn read_on(&mut self) -> io::Result<usize> {
        let mut chunk = [0; CHUNK_BYTES];
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
        let mut along = RecvAncillaryBuffer::new(&mut space);
        let received = loop {
            let mut parts = [IoSliceMut::new(&mut chunk)];
            match recvmsg(
                &self.stream,
                &mut parts,
                &mut along,
                RecvFlags::CMSG_CLOEXEC,
            ) {
                Ok(received) => break received,
                Err(rustix::io::Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        };
        for message in along.drain() {
            if let RecvAncillaryMessage::ScmRights(descriptors) = message {
                self.descriptors.extend(descriptors);
            }
        }
        self.unread.extend_from_slice(&chunk[..received.bytes]);
        Ok(received.bytes)
    }

    /// The stream itself.
    pub fn into_stream(self) -> UnixStream {
        self.stream
    }
}

impl AsFd for DescriptorLine {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.stream.as_fd()
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Read as _, Write as _};

    use super::*;

    fn pair() -> (DescriptorLine, DescriptorLine) {
        let (one, other) = UnixStream::pair().unwrap();
        let line = |stream| DescriptorLine::new(stream, Duration::from_secs(10)).unwrap();
        (line(one), line(other))
    }

    #[test]
    fn a_message_comes_with_its_descriptor_or_without() {
        let (mut here, mut there) = pair();
        let (mut near, far) = UnixStream::pair().unwrap();
        here.send(&"before", None).unwrap();
        here.send(&"take this", Some(far.as_fd())).unwrap();
        here.send(&"after", None).unwrap();
        drop((here, far));
        let mut next = || there.receive::<String>().unwrap();
        assert!(matches!(next(), Some((text, None)) if text == "before"));
        let Some((text, Some(descriptor))) = next() else {
            panic!("no descriptor came");
        };
        assert_eq!(text, "take this");
        UnixStream::from(descriptor).write_all(b"it works").unwrap();
        let mut heard = String::new();
        near.read_to_string(&mut heard).unwrap();
        assert_eq!(heard, "it works");
        assert!(matches!(next(), Some((text, None)) if text == "after"));
        assert!(next().is_none());
    }

    #[test]
    fn a_long_message_comes_whole() {
        let (mut here, mut there) = pair();
        let text = "m".repeat(1 << 20);
        let copy = text.clone();
        let sender = std::thread::spawn(move || here.send(&copy, None));
        let (received, _) = there.receive::<String>().unwrap().unwrap();
        sender.join().unwrap().unwrap();
        assert!(received == text);
    }

    #[test]
    fn what_is_no_message_is_refused() {
        let (one, mut other) = UnixStream::pair().unwrap();
        let mut line = DescriptorLine::new(one, Duration::from_secs(10)).unwrap();
        other.write_all(b"no JSON\n").unwrap();
        assert!(line.receive::<String>().is_err());
    }
}
