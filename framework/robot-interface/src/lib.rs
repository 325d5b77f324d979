//! What the parts of the reference robot say to each other.
//!
//! [`serial_line`] is the protocol between the main board and the motion board, [`camera_stream`]
//! the bytes that a camera sends. Both ends of each line, the simulated device and the driver
//! component, use this crate; nothing here opens a device or reads a clock.

#![forbid(unsafe_code)]

pub mod camera_stream;
pub mod serial_line;
mod start_mark;
