//! The bytes that a camera sends: one frame a picture.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | start mark `C4 3D B2 4E` |
//! | 2, 2 | width and height in pixels |
//! | 8 | time stamp in nanoseconds of robot time |
//! | 2 | CRC-16/IBM-3740 over width, height and time stamp |
//! | 3 n | pixels, RGB8, rows from the top, columns from the left |
//! | 4 | CRC-32/ISO-HDLC over the pixels |
//!
//! All numbers are little endian. The header has a checksum of its own so that a false start mark
//! never makes the receiver wait for a picture that is not coming.

mod decoder;
mod frame;

pub use decoder::PictureDecoder;
pub use frame::{MAXIMUM_PIXELS, Picture, encode, frame_length};
