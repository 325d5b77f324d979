//! A world in a process of its own, as the container sees it.

use std::io::{self, ErrorKind};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use robot_simulation::{Fault, RobotSummary};

use super::protocol::{ANSWER_LIMIT, Answer, Request};
use crate::descriptor_line::DescriptorLine;

/// How often the container asks how the drive goes: as often as the motion board reports.
pub(super) const LOOK_PERIOD: Duration = Duration::from_millis(20);

/// The way to a world in another process.
#[derive(Debug)]
pub struct RemoteWorld {
    inner: Mutex<Inner>,
}

#[derive(Debug)]
struct Inner {
    /// None once it was of no use any more: answers would come to the wrong questions.
    line: Option<DescriptorLine>,
    /// How the drive went when that was heard last.
    summary: RobotSummary,
}

impl RemoteWorld {
    /// The world at the other end of a stream.
    ///
    /// # Errors
    /// If nobody answers there.
    pub fn new(stream: UnixStream) -> io::Result<Self> {
        let mut line = DescriptorLine::new(stream, ANSWER_LIMIT)?;
        match ask(&mut line, &Request::Summary)? {
            (Answer::Summary(summary), _) => Ok(Self {
                inner: Mutex::new(Inner {
                    line: Some(line),
                    summary,
                }),
            }),
            (other, _) => Err(unexpected(&other)),
        }
    }

    /// How the drive went so far; what is known of it, if the world is gone.
    pub(super) fn summary(&self) -> RobotSummary {
        let answer = self.ask(&Request::Summary);
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        if let Ok((Answer::Summary(summary), _)) = answer {
            inner.summary = summary;
        }
        inner.summary
    }

    /// A picture of the drive so far, as SVG.
    ///
    /// # Errors
    /// If the world is gone.
    pub(super) fn picture(&self) -> io::Result<String> {
        match self.ask(&Request::Picture)? {
            (Answer::Picture(picture), _) => Ok(picture),
            (other, _) => Err(unexpected(&other)),
        }
    }

    /// Opens a device of the world.
    ///
    /// # Errors
    /// If there is no such device, it is unplugged, or the world is gone.
    pub(super) fn open(&self, device: &str) -> io::Result<(OwnedFd, Option<PathBuf>)> {
        match self.ask(&Request::Open(device.to_owned()))? {
            (Answer::Opened(path), Some(descriptor)) => Ok((descriptor, path)),
            (other, _) => Err(unexpected(&other)),
        }
    }

    /// Makes a fault of the hardware appear, or takes it away. Without a world there is none.
    pub(super) fn set_fault(&self, fault: Fault, present: bool) {
        let request = match present {
            true => Request::SetFault(fault),
            false => Request::ClearFault(fault),
        };
        let _world_is_gone = self.ask(&request);
    }

    fn ask(&self, request: &Request) -> io::Result<(Answer, Option<OwnedFd>)> {
        let mut inner = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        let line = inner.line.as_mut().ok_or(ErrorKind::NotConnected)?;
        let answer = ask(line, request);
        if answer.is_err() {
            inner.line = None;
        }
        match answer? {
            (Answer::Refused(reason), _) => Err(io::Error::new(ErrorKind::NotFound, reason)),
            answer => Ok(answer),
        }
    }
}

fn ask(line: &mut DescriptorLine, request: &Request) -> io::Result<(Answer, Option<OwnedFd>)> {
    line.send(request, None)?;
    let answer = line.receive()?;
    answer.ok_or_else(|| io::Error::new(ErrorKind::UnexpectedEof, "the world has ended"))
}

fn unexpected(answer: &Answer) -> io::Error {
    let message = format!("the world answered something else: {answer:?}");
    io::Error::new(ErrorKind::InvalidData, message)
}
