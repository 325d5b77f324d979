//! One client: a request in, its answer out, then the next.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use super::Control;
use crate::control::protocol::{Answer, MAX_REQUEST_BYTES, Request};

/// Read at a time; a client that sends much waits while others are served.
const CHUNK_BYTES: usize = 4096;

/// One client.
#[derive(Debug)]
pub(super) struct Connection {
    stream: UnixStream,
    input: Vec<u8>,
    /// The answer that is being written, and how much of it has been.
    output: Vec<u8>,
    written: usize,
    /// Whether it is let go once it has its answer.
    closing: bool,
    patience: Duration,
    deadline: Instant,
}

impl Connection {
    /// A client that has just come.
    pub(super) fn new(stream: UnixStream, now: Instant, patience: Duration) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        Ok(Self {
            stream,
            input: Vec::new(),
            output: Vec::new(),
            written: 0,
            closing: false,
            patience,
            deadline: now + patience,
        })
    }

    pub(super) fn stream(&self) -> &UnixStream {
        &self.stream
    }

    /// When it is let go. Half a request, or half an answer that was read, does not put it off.
    pub(super) fn deadline(&self) -> Instant {
        self.deadline
    }

    /// Whether an answer waits for the client. It says nothing more until it has read that.
    pub(super) fn is_writing(&self) -> bool {
        self.written < self.output.len()
    }

    /// Whether a whole request has come that has not been answered: there may be nothing more to
    /// wait for.
    pub(super) fn has_request(&self) -> bool {
        !self.is_writing() && self.input.contains(&b'\n')
    }

    /// Does what can be done without waiting, one request at most; whether the client stays.
    pub(super) fn serve(&mut self, control: &dyn Control, now: Instant) -> bool {
        let served = match self.is_writing() || self.has_request() {
            true => Ok(()),
            false => self.read(),
        };
        if !self.is_writing()
            && let Some(answer) = self.answer(control)
        {
            self.output = answer.to_line();
        }
        let served = served.and_then(|()| self.write(now));
        let dismissed = self.closing && !self.is_writing();
        served.is_ok() && !dismissed
    }

    /// Tells a client that is not taken why, as far as that goes without waiting.
    pub(super) fn dismiss(&mut self, answer: &Answer) {
        let _may_not_listen = self.stream.write(&answer.to_line());
    }

    fn read(&mut self) -> io::Result<()> {
        let mut chunk = [0; CHUNK_BYTES];
        match self.stream.read(&mut chunk) {
            // Half a line that was left behind is no request.
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => {
                self.input.extend_from_slice(&chunk[..count]);
                Ok(())
            }
            Err(error) if is_passing(&error) => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Answers the first line of what has come, if it has come whole. Lines that follow wait until
    /// that has been read.
    fn answer(&mut self, control: &dyn Control) -> Option<Answer> {
        let end = self.input.iter().position(|byte| *byte == b'\n');
        if end.unwrap_or(self.input.len()) > MAX_REQUEST_BYTES {
            self.closing = true;
            self.input.clear();
            return Some(Answer::Refused(format!(
                "this is no request: it has more than {MAX_REQUEST_BYTES} bytes"
            )));
        }
        let line: Vec<u8> = self.input.drain(..=end?).collect();
        Some(match Request::from_line(&line) {
            Ok(request) => control.handle(request),
            Err(why) => Answer::Refused(why),
        })
    }

    fn write(&mut self, now: Instant) -> io::Result<()> {
        if !self.is_writing() {
            return Ok(());
        }
        match self.stream.write(&self.output[self.written..]) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(count) => self.written += count,
            Err(error) if is_passing(&error) => {}
            Err(error) => return Err(error),
        }
        if !self.is_writing() {
            self.output = Vec::new();
            self.written = 0;
            self.deadline = now + self.patience;
        }
        Ok(())
    }
}

fn is_passing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
