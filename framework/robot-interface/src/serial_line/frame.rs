//! Framing: start mark, kind, length, payload, checksum.

use crc::{CRC_16_IBM_3740, Crc};

use super::message::{BoardReport, Message, MotionCommand};

/// No byte pair of a small number looks like this, and both levels of the line alternate in it.
pub(super) const START_MARK: [u8; 2] = [0xA5, 0x5A];
const HEADER_LENGTH: usize = 4;
const CHECKSUM_LENGTH: usize = 2;
const COMMAND_KIND: u8 = 1;
const REPORT_KIND: u8 = 2;
const CHECKSUM: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// The longest frame of the line in bytes.
pub const MAXIMUM_FRAME_LENGTH: usize =
    HEADER_LENGTH + BoardReport::PAYLOAD_LENGTH + CHECKSUM_LENGTH;

/// The bytes of one frame.
pub fn encode(message: &Message) -> Vec<u8> {
    match message {
        Message::Command(command) => encode_payload(COMMAND_KIND, &command.to_payload()),
        Message::Report(report) => encode_payload(REPORT_KIND, &report.to_payload()),
    }
}

fn encode_payload(kind: u8, payload: &[u8]) -> Vec<u8> {
    let mut frame = Vec::with_capacity(MAXIMUM_FRAME_LENGTH);
    frame.extend_from_slice(&START_MARK);
    frame.push(kind);
    frame.push(payload.len() as u8);
    frame.extend_from_slice(payload);
    let checksum = CHECKSUM.checksum(&frame[START_MARK.len()..]);
    frame.extend_from_slice(&checksum.to_le_bytes());
    frame
}

/// What the start of a buffer turned out to be.
pub(super) enum Parsed {
    /// A frame of so many bytes.
    Frame(Message, usize),
    /// May become a frame.
    Incomplete,
    /// Can never become one: wrong kind, wrong length, wrong checksum or senseless content.
    Bad,
}

/// Reads the frame that starts with the first byte of `bytes`, whose start mark is checked as far
/// as it is there.
pub(super) fn parse(bytes: &[u8]) -> Parsed {
    let [_, _, kind, length, ..] = *bytes else {
        return Parsed::Incomplete;
    };
    let length = usize::from(length);
    match (kind, length) {
        (COMMAND_KIND, MotionCommand::PAYLOAD_LENGTH)
        | (REPORT_KIND, BoardReport::PAYLOAD_LENGTH) => {}
        _ => return Parsed::Bad,
    }
    let checksum_at = HEADER_LENGTH + length;
    let frame_length = checksum_at + CHECKSUM_LENGTH;
    let Some(checksum) = bytes.get(checksum_at..frame_length) else {
        return Parsed::Incomplete;
    };
    if CHECKSUM
        .checksum(&bytes[START_MARK.len()..checksum_at])
        .to_le_bytes()
        != checksum
    {
        return Parsed::Bad;
    }
    let payload = &bytes[HEADER_LENGTH..checksum_at];
    let message = match kind {
        COMMAND_KIND => MotionCommand::from_payload(payload).map(Message::Command),
        _ => BoardReport::from_payload(payload).map(Message::Report),
    };
    message.map_or(Parsed::Bad, |message| Parsed::Frame(message, frame_length))
}
