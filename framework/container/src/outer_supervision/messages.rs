//! What parent and container say to each other.

use std::time::Duration;

use serde::{Deserialize, Serialize};

/// In which a line of parent and container carries what it is to carry: either reads at once when it
/// lives at all.
pub(super) const LINE_LIMIT: Duration = Duration::from_secs(5);

/// What the parent tells a container first. The way to the simulated world comes along, if there is
/// one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Welcome {
    /// When the first container was started, in nanoseconds of the monotonic clock.
    pub(super) first_start_ns: u64,
    /// How many containers have died.
    pub(super) restarts: u32,
    /// Why there is another one.
    pub(super) death: Option<Death>,
}

/// The record of a container's death. Times are nanoseconds of the monotonic clock.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Death {
    /// What was seen, in words.
    pub(super) seen: String,
    /// Why it was judged so.
    pub(super) judged: String,
    /// What is done.
    pub(super) done: String,
    /// When the container was heard last.
    pub(super) heard_ns: u64,
    /// When it was known to be dead, or taken for it.
    pub(super) seen_ns: u64,
    /// When its successor was started.
    pub(super) restarted_ns: u64,
}

/// What a container lets its parent know, a byte each: these never fill a socket before the other
/// end has been silent for long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    /// It runs, and its fault manager looks after things.
    Beat,
    /// It stops in order.
    Stops,
}

impl Sign {
    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Beat => b'.',
            Self::Stops => b'S',
        }
    }

    /// The sign of this byte; there are no others than these two.
    pub(super) fn from_byte(byte: u8) -> Option<Self> {
        [Self::Beat, Self::Stops]
            .into_iter()
            .find(|sign| sign.byte() == byte)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_told_apart() {
        for sign in [Sign::Beat, Sign::Stops] {
            assert_eq!(Sign::from_byte(sign.byte()), Some(sign));
        }
        assert_eq!(Sign::from_byte(b'x'), None);
    }
}
