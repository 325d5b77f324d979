//! Messages with open files, between the container and a host: what instances to run, and the
//! devices that they open.

use std::io::{self, IoSlice, IoSliceMut};
use std::mem::MaybeUninit;
use std::os::fd::{BorrowedFd, OwnedFd};

use rustix::net::{
    AddressFamily, RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SendAncillaryBuffer,
    SendAncillaryMessage, SendFlags, SocketFlags, SocketType, recvmsg, sendmsg, socketpair,
};

/// Longest message: the description of a component with as many ports as any has.
const LONGEST_MESSAGE: usize = 160 * 1024;

/// Files that one message may carry.
const MOST_FILES: usize = 3;

/// Two ends of a line for whole messages; neither stays open in a process that is started.
pub(super) fn pair() -> io::Result<(OwnedFd, OwnedFd)> {
    let kind = SocketType::SEQPACKET;
    Ok(socketpair(
        AddressFamily::UNIX,
        kind,
        SocketFlags::CLOEXEC,
        None,
    )?)
}

/// Sends one message.
pub(super) fn send(
    line: BorrowedFd<'_>,
    message: &[u8],
    files: &[BorrowedFd<'_>],
) -> io::Result<()> {
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(MOST_FILES))];
    let mut ancillary = SendAncillaryBuffer::new(&mut space);
    if !files.is_empty() && !ancillary.push(SendAncillaryMessage::ScmRights(files)) {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    sendmsg(
        line,
        &[IoSlice::new(message)],
        &mut ancillary,
        SendFlags::NOSIGNAL,
    )?;
    Ok(())
}

/// Waits for one message; `None` when the other side is gone.
pub(super) fn receive(line: BorrowedFd<'_>) -> io::Result<Option<(Vec<u8>, Vec<OwnedFd>)>> {
    let mut message = vec![0; LONGEST_MESSAGE];
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(MOST_FILES))];
    let mut ancillary = RecvAncillaryBuffer::new(&mut space);
    let received = loop {
        let mut parts = [IoSliceMut::new(&mut message)];
        match recvmsg(line, &mut parts, &mut ancillary, RecvFlags::CMSG_CLOEXEC) {
            Ok(received) => break received,
            Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    };
    if received.bytes == 0 {
        return Ok(None);
    }
    message.truncate(received.bytes);
    let files = ancillary
        .drain()
        .filter_map(|part| match part {
            RecvAncillaryMessage::ScmRights(files) => Some(files),
            _ => None,
        })
        .flatten();
    Ok(Some((message, files.collect())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::fd::AsFd as _;

    #[test]
    fn a_message_arrives_whole_with_its_files_and_the_end_is_seen() {
        let (near, far) = pair().expect("sockets");
        let file = tempfile::tempfile().expect("a file");
        send(near.as_fd(), b"first", &[file.as_fd()]).expect("sent");
        send(near.as_fd(), b"second", &[]).expect("sent");
        let (message, files) = receive(far.as_fd()).expect("read").expect("a message");
        assert_eq!((message.as_slice(), files.len()), (&b"first"[..], 1));
        let (message, files) = receive(far.as_fd()).expect("read").expect("a message");
        assert_eq!((message.as_slice(), files.len()), (&b"second"[..], 0));
        drop(near);
        assert!(receive(far.as_fd()).expect("read").is_none());
    }
}
