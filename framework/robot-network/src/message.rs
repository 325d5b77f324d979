//! What robots say to each other besides data of ports, as JSON.
//!
//! Every message that comes has a bound, and one that cannot be understood is refused by name: a
//! robot must not fall ill of what another one says.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A database of a thousand components has some 300 KB.
pub const BYTES_MAXIMUM: usize = 1 << 20;

/// A sign of life, several times within the limit of silence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Beat {
    /// Which of the robot's lives.
    pub incarnation: u64,
    /// The latest term that it knows.
    pub term: u64,
    /// Who decides, as far as it knows.
    pub decider: Option<String>,
}

/// What a robot has: its component database, `DB_E-PBOs` of the ReFrESH paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Database {
    /// Whose it is.
    pub robot: String,
    /// Architecture that its libraries are built for, as in `x86_64-linux`.
    pub architecture: String,
    /// Version of the contract between container and components.
    pub abi: u32,
    /// Its components.
    pub components: Vec<ComponentEntry>,
}

/// One component of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComponentEntry {
    /// Name of the instance.
    pub name: String,
    /// Name of its library's component.
    pub library: String,
    /// SHA-256 of the library's file, in hexadecimal digits.
    pub library_sha256: String,
    /// Whether it runs.
    pub runs: bool,
    /// Outputs that other robots may listen to.
    pub offers: Vec<OfferedPort>,
}

/// An output that other robots may listen to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OfferedPort {
    /// Name of the port.
    pub port: String,
    /// Name of its data type.
    pub data_type: String,
}

/// A fault that a robot's fault manager has confirmed, for all others.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultNotice {
    /// The component that is to blame.
    pub component: String,
    /// What kind of fault.
    pub kind: String,
    /// When it was confirmed, in nanoseconds of the sender's clock.
    pub t_ns: u64,
}

/// A message that is not understood.
#[derive(Debug, Error)]
pub enum BadMessage {
    /// Too long.
    #[error("it has {0} bytes, more than {BYTES_MAXIMUM}")]
    TooLong(usize),
    /// Not what was expected.
    #[error("{0}")]
    Content(#[from] serde_json::Error),
}

/// A message as bytes.
///
/// # Errors
/// When it holds what JSON has no form for, or is too long.
pub fn encode<Message: Serialize>(message: &Message) -> Result<Vec<u8>, BadMessage> {
    let bytes = serde_json::to_vec(message)?;
    bounded(&bytes)?;
    Ok(bytes)
}

/// Bytes as a message.
///
/// # Errors
/// When they are none of this kind.
pub fn decode<Message: DeserializeOwned>(bytes: &[u8]) -> Result<Message, BadMessage> {
    bounded(bytes)?;
    Ok(serde_json::from_slice(bytes)?)
}

fn bounded(bytes: &[u8]) -> Result<(), BadMessage> {
    match bytes.len() > BYTES_MAXIMUM {
        true => Err(BadMessage::TooLong(bytes.len())),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_arrive_as_they_were_sent() {
        let beat = Beat {
            incarnation: 3,
            term: 2,
            decider: Some("R1".to_owned()),
        };
        let bytes = encode(&beat).expect("a message");
        assert_eq!(bytes, br#"{"incarnation":3,"term":2,"decider":"R1"}"#);
        assert_eq!(decode::<Beat>(&bytes).expect("a beat"), beat);
    }

    #[test]
    fn what_is_no_message_is_refused() {
        let long = vec![b' '; BYTES_MAXIMUM + 1];
        for (bytes, words) in [
            (&b""[..], "EOF"),
            (b"{\"incarnation\":3}", "missing field `term`"),
            (
                b"{\"incarnation\":-1,\"term\":2,\"decider\":null}",
                "invalid value",
            ),
            (b"\xff\xfe", "expected value"),
            (&long, "more than 1048576"),
        ] {
            let error = decode::<Beat>(bytes).expect_err(words).to_string();
            assert!(error.contains(words), "{error} has no '{words}'");
        }
    }
}
