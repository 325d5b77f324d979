//! From bytes as they arrive to messages.

use crate::start_mark::bytes_before;

use super::frame::{MAXIMUM_FRAME_LENGTH, Parsed, START_MARK, parse};
use super::message::Message;

/// Finds the frames in a stream of bytes, whatever stands between them.
///
/// Holds at most one unfinished frame. After a bad frame it looks for the next start mark inside
/// the bytes of that frame, so a whole frame behind a broken one is never lost.
#[derive(Debug, Clone, Default)]
pub struct Decoder {
    pending: Vec<u8>,
    bad_frames: u64,
}

impl Decoder {
    /// A decoder at the start of a stream.
    pub fn new() -> Self {
        Self {
            pending: Vec::with_capacity(2 * MAXIMUM_FRAME_LENGTH),
            bad_frames: 0,
        }
    }

    /// Takes the next bytes of the stream and returns the messages that they complete, in order.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<Message> {
        let mut messages = Vec::new();
        // In pieces, so that the buffer stays small however much arrives at once.
        for piece in bytes.chunks(MAXIMUM_FRAME_LENGTH) {
            self.pending.extend_from_slice(piece);
            self.take_messages(&mut messages);
        }
        messages
    }

    /// Start marks so far that did not begin a good frame.
    pub fn bad_frames(&self) -> u64 {
        self.bad_frames
    }

    fn take_messages(&mut self, messages: &mut Vec<Message>) {
        let mut start = 0;
        loop {
            start += bytes_before(&START_MARK, &self.pending[start..]);
            match parse(&self.pending[start..]) {
                Parsed::Frame(message, length) => {
                    messages.push(message);
                    start += length;
                }
                Parsed::Bad => {
                    self.bad_frames += 1;
                    start += 1;
                }
                Parsed::Incomplete => break,
            }
        }
        self.pending.drain(..start);
    }
}
