//! From bytes as they arrive to pictures.

use crate::start_mark::bytes_before;

use super::frame::{Parsed, Picture, START_MARK, frame_length, parse};

/// Finds the pictures in a stream of bytes, whatever stands between them.
///
/// Holds at most one unfinished frame of the largest picture, besides what one call brings.
#[derive(Debug, Clone, Default)]
pub struct PictureDecoder {
    pending: Vec<u8>,
    bad_frames: u64,
    pictures: u64,
}

impl PictureDecoder {
    /// A decoder at the start of a stream.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the next bytes of the stream and returns the newest picture that they complete; older
    /// ones in the same bytes are skipped, because a robot acts on what it sees now.
    pub fn push(&mut self, bytes: &[u8]) -> Option<Picture> {
        self.pending.extend_from_slice(bytes);
        let mut newest = None;
        let mut start = 0;
        loop {
            start += bytes_before(&START_MARK, &self.pending[start..]);
            match parse(&self.pending[start..]) {
                Parsed::Picture(picture) => {
                    start += frame_length(picture.width, picture.height);
                    self.pictures += 1;
                    newest = Some(picture);
                }
                Parsed::Bad => {
                    self.bad_frames += 1;
                    start += 1;
                }
                Parsed::Incomplete => break,
            }
        }
        self.pending.drain(..start);
        newest
    }

    /// Whole pictures so far, the skipped ones included.
    pub fn pictures(&self) -> u64 {
        self.pictures
    }

    /// Start marks so far that did not begin a good frame.
    pub fn bad_frames(&self) -> u64 {
        self.bad_frames
    }
}
