//! What the parts of the reference robot say to each other.
//!
//! [`serial_line`] is the protocol between the main board and the motion board, [`camera_stream`]
//! the bytes that a camera sends; both ends of each line, the simulated device and the driver
//! component, use this crate. [`port_data`] is what travels between the components themselves;
//! [`differential_drive`] makes of it what wheels do.
//! Nothing here opens a device or reads a clock.

#![forbid(unsafe_code)]

pub mod camera_stream;
pub mod differential_drive;
pub mod port_data;
pub mod serial_line;
mod start_mark;
