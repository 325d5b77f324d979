//! A datum of a port on its way to another robot.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | `SFD1` |
//! | 8 | layout hash of the data type |
//! | 8 | term in which it is sent |
//! | 8 | which of the sending robot's lives |
//! | 8 | when it was written, in nanoseconds of the sender's clock |
//! | n | the datum as it lies in memory |
//!
//! All numbers are little endian, as is the memory of all machines that the container runs on.

use thiserror::Error;

const MARK: [u8; 4] = *b"SFD1";

/// Bytes before the datum.
pub const HEADER_LENGTH: usize = 36;

/// What is known of a datum besides itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// Layout hash of its data type; 0 where none is known.
    pub layout_hash: u64,
    /// Term in which it is sent.
    pub term: u64,
    /// Which of the sending robot's lives.
    pub incarnation: u64,
    /// When it was written, in nanoseconds of the sender's clock.
    pub stamp_ns: u64,
}

/// Bytes that are no datum of the type that is expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum BadFrame {
    /// Too short for a header, or of something else.
    #[error("it is no datum of a port")]
    Foreign,
    /// Another layout.
    #[error(
        "its type has the layout {found:016x}, not {expected:016x}: build both robots' components \
         from the same definition of the type"
    )]
    Layout {
        /// The layout hash in the frame.
        found: u64,
        /// That of the input.
        expected: u64,
    },
    /// Another size.
    #[error("it has {found} bytes, not {expected}")]
    Size {
        /// Bytes behind the header.
        found: usize,
        /// Size of the type.
        expected: usize,
    },
}

/// Puts header and datum into `frame`, whose allocation is used again.
pub fn encode(header: &Header, datum: &[u8], frame: &mut Vec<u8>) {
    frame.clear();
    frame.extend_from_slice(&MARK);
    for number in [
        header.layout_hash,
        header.term,
        header.incarnation,
        header.stamp_ns,
    ] {
        frame.extend_from_slice(&number.to_le_bytes());
    }
    frame.extend_from_slice(datum);
}

/// Takes a frame apart.
///
/// # Errors
/// When it is not of the type with this layout hash (0 where none is known) and size.
pub fn decode(frame: &[u8], layout_hash: u64, size: usize) -> Result<(Header, &[u8]), BadFrame> {
    let header = frame.get(..HEADER_LENGTH).ok_or(BadFrame::Foreign)?;
    if header[..4] != MARK {
        return Err(BadFrame::Foreign);
    }
    let number = |index: usize| {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&header[4 + 8 * index..12 + 8 * index]);
        u64::from_le_bytes(bytes)
    };
    let header = Header {
        layout_hash: number(0),
        term: number(1),
        incarnation: number(2),
        stamp_ns: number(3),
    };
    let both_known = header.layout_hash != 0 && layout_hash != 0;
    if both_known && header.layout_hash != layout_hash {
        return Err(BadFrame::Layout {
            found: header.layout_hash,
            expected: layout_hash,
        });
    }
    let datum = &frame[HEADER_LENGTH..];
    if datum.len() != size {
        return Err(BadFrame::Size {
            found: datum.len(),
            expected: size,
        });
    }
    Ok((header, datum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_encoded_is_decoded_and_nothing_else() {
        let header = Header {
            layout_hash: 0x1234_5678_9abc_def0,
            term: 3,
            incarnation: 4,
            stamp_ns: 5,
        };
        let mut frame = vec![9; 100];
        encode(&header, &[1, 2, 3], &mut frame);
        assert_eq!(frame.len(), HEADER_LENGTH + 3);
        let hash = header.layout_hash;
        for expected in [hash, 0] {
            assert_eq!(decode(&frame, expected, 3), Ok((header, &[1, 2, 3][..])));
        }
        let layout = BadFrame::Layout {
            found: hash,
            expected: 1,
        };
        let size = |found, expected| BadFrame::Size { found, expected };
        for (bytes, expected_hash, expected_size, refusal) in [
            (&frame[..], 1, 3, layout),
            (&frame[..], hash, 4, size(3, 4)),
            (&frame[..HEADER_LENGTH], hash, 3, size(0, 3)),
            (&frame[..HEADER_LENGTH - 1], hash, 3, BadFrame::Foreign),
            (&frame[1..], hash, 3, BadFrame::Foreign),
            (&[], hash, 0, BadFrame::Foreign),
        ] {
            assert_eq!(decode(bytes, expected_hash, expected_size), Err(refusal));
        }
    }
}
