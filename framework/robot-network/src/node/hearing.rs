//! What comes from other robots, passed on to whoever looks after it.

use crossbeam::channel::Sender;
use zenoh::sample::{Sample, SampleKind};

use super::key;
use crate::message::{self, Beat, FaultNotice};

/// Something that another robot has said.
#[derive(Debug, Clone, PartialEq)]
pub enum Heard {
    /// Its token is there.
    Alive {
        /// Its name.
        robot: String,
        /// Which of its lives.
        incarnation: u64,
    },
    /// Its token is gone.
    Gone {
        /// Its name.
        robot: String,
        /// Which of its lives.
        incarnation: u64,
    },
    /// A sign of life.
    Beat {
        /// Its name.
        robot: String,
        /// What it says.
        beat: Beat,
    },
    /// A fault of one of its components.
    Fault {
        /// Its name.
        robot: String,
        /// What it says.
        notice: FaultNotice,
    },
    /// Something that is not understood.
    Unintelligible {
        /// Under which key it came.
        key: String,
        /// What is wrong with it.
        reason: String,
    },
}

/// Passes on signs of life.
pub(super) fn hear_beats(own: String, sender: Sender<Heard>) -> impl Fn(Sample) + Send + Sync {
    hear(own, sender, |robot, beat| Heard::Beat { robot, beat })
}

/// Passes on faults.
pub(super) fn hear_faults(own: String, sender: Sender<Heard>) -> impl Fn(Sample) + Send + Sync {
    hear(own, sender, |robot, notice| Heard::Fault { robot, notice })
}

/// Passes on what others say. A beat in this robot's own name is passed on too: there may be a
/// namesake.
fn hear<Message: serde::de::DeserializeOwned>(
    own: String,
    sender: Sender<Heard>,
    heard: impl Fn(String, Message) -> Heard + Send + Sync,
) -> impl Fn(Sample) + Send + Sync {
    move |sample| {
        let key = sample.key_expr().as_str();
        let Some(robot) = key::robot(key) else {
            return;
        };
        let is_own_fault = robot == own && key.starts_with("steadfast/fault/");
        if is_own_fault {
            return;
        }
        let message = message::decode(&sample.payload().to_bytes());
        let what = match message {
            Ok(message) => heard(robot.to_owned(), message),
            Err(error) => Heard::Unintelligible {
                key: key.to_owned(),
                reason: error.to_string(),
            },
        };
        // Full: the next beat says the same.
        let _lost = sender.try_send(what);
    }
}

/// Passes on that tokens come and go; not that this robot's own has gone.
pub(super) fn hear_tokens(own: String, sender: Sender<Heard>) -> impl Fn(Sample) + Send + Sync {
    move |sample| {
        let Some((robot, incarnation)) = key::life(sample.key_expr().as_str()) else {
            return;
        };
        let is_there = sample.kind() == SampleKind::Put;
        let robot = robot.to_owned();
        if robot == own && !is_there {
            return;
        }
        let what = match is_there {
            true => Heard::Alive { robot, incarnation },
            false => Heard::Gone { robot, incarnation },
        };
        let _lost = sender.try_send(what);
    }
}
