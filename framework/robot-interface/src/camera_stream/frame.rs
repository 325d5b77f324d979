//! One picture and its frame.

use crc::{CRC_16_IBM_3740, CRC_32_ISO_HDLC, Crc};

/// Most pixels of a picture (640 x 480); bounds what a receiver keeps.
pub const MAXIMUM_PIXELS: usize = 640 * 480;

pub(super) const START_MARK: [u8; 4] = [0xC4, 0x3D, 0xB2, 0x4E];
const HEADER_CHECKSUM_AT: usize = START_MARK.len() + 12;
const HEADER_LENGTH: usize = HEADER_CHECKSUM_AT + 2;
const PIXEL_CHECKSUM_LENGTH: usize = 4;
const BYTES_PER_PIXEL: usize = 3;
const HEADER_CHECKSUM: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);
const PIXEL_CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// A colour picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u16,
    /// Height in pixels.
    pub height: u16,
    /// When it was taken, in nanoseconds of robot time.
    pub time_stamp_ns: u64,
    /// Three bytes a pixel (red, green, blue), rows from the top, columns from the left.
    pub pixels: Vec<u8>,
}

/// Length in bytes of the frame of a picture of this size.
pub fn frame_length(width: u16, height: u16) -> usize {
    HEADER_LENGTH
        + usize::from(width) * usize::from(height) * BYTES_PER_PIXEL
        + PIXEL_CHECKSUM_LENGTH
}

/// The bytes of one frame.
///
/// # Panics
/// When `pixels` does not hold width x height pixels.
pub fn encode(picture: &Picture) -> Vec<u8> {
    let length = frame_length(picture.width, picture.height);
    assert_eq!(
        picture.pixels.len() + HEADER_LENGTH + PIXEL_CHECKSUM_LENGTH,
        length,
        "a picture holds width x height pixels"
    );
    let mut frame = Vec::with_capacity(length);
    frame.extend_from_slice(&START_MARK);
    frame.extend_from_slice(&picture.width.to_le_bytes());
    frame.extend_from_slice(&picture.height.to_le_bytes());
    frame.extend_from_slice(&picture.time_stamp_ns.to_le_bytes());
    let checksum = HEADER_CHECKSUM.checksum(&frame[START_MARK.len()..]);
    frame.extend_from_slice(&checksum.to_le_bytes());
    frame.extend_from_slice(&picture.pixels);
    frame.extend_from_slice(&PIXEL_CHECKSUM.checksum(&picture.pixels).to_le_bytes());
    frame
}

/// What the start of a buffer turned out to be.
pub(super) enum Parsed {
    /// A whole, undamaged picture.
    Picture(Picture),
    /// May become one.
    Incomplete,
    /// Can never become one.
    Bad,
}

/// Reads the frame that starts with the first byte of `bytes`, whose start mark has been checked
/// as far as it is there.
pub(super) fn parse(bytes: &[u8]) -> Parsed {
    let Some(header) = bytes.get(..HEADER_LENGTH) else {
        return Parsed::Incomplete;
    };
    let (fields, checksum) = header[START_MARK.len()..].split_at(12);
    if HEADER_CHECKSUM.checksum(fields).to_le_bytes() != checksum {
        return Parsed::Bad;
    }
    let width = u16::from_le_bytes([fields[0], fields[1]]);
    let height = u16::from_le_bytes([fields[2], fields[3]]);
    if usize::from(width) * usize::from(height) > MAXIMUM_PIXELS {
        return Parsed::Bad;
    }
    let Some(body) = bytes.get(HEADER_LENGTH..frame_length(width, height)) else {
        return Parsed::Incomplete;
    };
    let (pixels, checksum) = body.split_at(body.len() - PIXEL_CHECKSUM_LENGTH);
    if PIXEL_CHECKSUM.checksum(pixels).to_le_bytes() != checksum {
        return Parsed::Bad;
    }
    let mut time_stamp = [0; 8];
    time_stamp.copy_from_slice(&fields[4..12]);
    Parsed::Picture(Picture {
        width,
        height,
        time_stamp_ns: u64::from_le_bytes(time_stamp),
        pixels: pixels.to_vec(),
    })
}
