//! The line between the main board and the motion board, after table 4 of Ahn et al. (2012).
//!
//! | bytes | content |
//! |---|---|
//! | 2 | start mark `A5 5A` |
//! | 1 | kind: `01` motion command (down), `02` board report (up) |
//! | 1 | length of the payload |
//! | n | payload |
//! | 2 | CRC-16/IBM-3740 ("CCITT", start value FFFF) over kind, length and payload |
//!
//! All numbers are little endian, as the AVR of the motion board stores them. A report is 25 bytes;
//! fifty a second use a ninth of a line at 115,200 baud.

mod board_line;
mod decoder;
mod frame;
mod message;

pub use board_line::BoardLine;
pub use decoder::Decoder;
pub use frame::{MAXIMUM_FRAME_LENGTH, encode};
pub use message::{BoardReport, Message, MotionCommand, MotionType, SONAR_COUNT};
