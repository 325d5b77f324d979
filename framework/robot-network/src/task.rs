//! What robots that do a task together say to each other, as JSON.
//!
//! The one who decides asks the others for estimates, has them change over, and tells what runs; each
//! tells all others what it has and how well it does. Everything is sent to one robot, in the term of
//! the one who decides; an answer carries the numbers of its question. Numbers of components, robots
//! and links are those of the task, which must be the same on all robots ([`fingerprint`]).

use base64_simd::STANDARD as BASE64;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::package;

/// A component on a robot: component, robot.
pub type Placed = (usize, usize);

/// A message about a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TaskMessage {
    /// [`fingerprint`] of the task.
    pub task: String,
    /// The latest term that the sender knows.
    pub term: u64,
    /// Which of the sender's lives.
    pub incarnation: u64,
    /// What is said.
    pub content: TaskContent,
}

/// What is said.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaskContent {
    /// From the one who decides: this runs.
    Running {
        /// All of it.
        placements: Vec<Placed>,
        /// How a decision has just ended, in words.
        decided: Option<String>,
    },
    /// What a robot has and how well it does.
    Report(RobotReport),
    /// Have components run for an estimate.
    Estimate(EstimateRequest),
    /// What came of that.
    Estimated {
        /// Of which step.
        step: Step,
        /// Errors of what was run, as [`Number`]s; none where nothing tells it.
        errors: Vec<(Placed, Option<Number>)>,
        /// What was asked to be told.
        data: Vec<LinkDatum>,
        /// Why it was in vain.
        failure: Option<String>,
    },
    /// Tell the registered memory of components.
    Remember {
        /// For which change.
        step: Step,
        /// Whose.
        placements: Vec<Placed>,
    },
    /// The memory that was asked for.
    Memories {
        /// For which change.
        step: Step,
        /// Of those that have registered any.
        memories: Vec<(usize, Bytes)>,
    },
    /// Begin to do the task in another way.
    Begin {
        /// Which change.
        step: Step,
        /// What shall run.
        wanted: Vec<Placed>,
        /// What runs.
        before: Vec<Placed>,
        /// Memory with which components go on that ran on another robot, by component.
        memories: Vec<(usize, Bytes)>,
    },
    /// It has been begun.
    Begun {
        /// Which change.
        step: Step,
    },
    /// All inputs here have changed over.
    Switched {
        /// Which change.
        step: Step,
    },
    /// It cannot be done; here everything has gone back.
    Failed {
        /// Which change.
        step: Step,
        /// Why.
        reason: String,
    },
    /// It is good: give up what is not needed any more.
    Finish {
        /// Which change.
        step: Step,
    },
    /// It is not: go back.
    GoBack {
        /// Which change.
        step: Step,
    },
}

/// A step of a decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Step {
    /// Number of the decision.
    pub decision: u64,
    /// Number of the candidate.
    pub number: usize,
    /// Which part of its rehearsal; 0 for a change.
    pub part: usize,
}

/// What a robot has and how well it does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobotReport {
    /// Components that it has, and that are not lost.
    pub components: Vec<usize>,
    /// What it has of each resource.
    pub available: Vec<Number>,
    /// How well its part of what runs does: error and use of resources. One that nothing is known of
    /// yet is not in it.
    pub performances: Vec<(usize, Number, Vec<Number>)>,
    /// Whether evaluators have had something new to look at.
    pub is_new: bool,
}

/// Asks to run components of a candidate for an estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimateRequest {
    /// Which step.
    pub step: Step,
    /// The whole candidate.
    pub candidate: Vec<Placed>,
    /// What is to be run, in this order.
    pub run: Vec<Placed>,
    /// Data to run on.
    pub data: Vec<LinkDatum>,
    /// Data to be told: of which link, written by whom.
    pub tell: Vec<(usize, Placed)>,
}

/// A datum on a link of the task.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkDatum {
    /// Number of the link.
    pub link: usize,
    /// Who has written it.
    pub from: Placed,
    /// The datum as it lies in memory.
    pub bytes: Bytes,
}

/// Bytes, in JSON as text in base64.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Bytes(pub Vec<u8>);

/// A number that may be none: an evaluator or estimator may lie, and JSON has no form for that. It
/// travels as its bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Number(u64);

impl From<f64> for Number {
    fn from(number: f64) -> Self {
        Self(number.to_bits())
    }
}

impl From<Number> for f64 {
    fn from(number: Number) -> Self {
        Self::from_bits(number.0)
    }
}

impl Serialize for Bytes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&BASE64.encode_to_string(&self.0))
    }
}

impl<'de> Deserialize<'de> for Bytes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let bytes = BASE64.decode_to_vec(text);
        bytes.map(Self).map_err(serde::de::Error::custom)
    }
}

/// Tells tasks apart: sixteen hexadecimal digits of a description.
pub fn fingerprint(description: &str) -> String {
    let mut digits = package::sha256(description.as_bytes());
    digits.truncate(16);
    digits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::{decode, encode};

    const STEP: Step = Step {
        decision: 7,
        number: 9,
        part: 0,
    };

    #[test]
    fn numbers_and_bytes_arrive_as_they_were_sent() {
        for number in [0.25, f64::INFINITY, -1.0] {
            let message = TaskMessage {
                task: fingerprint("servoing"),
                term: 3,
                incarnation: 5,
                content: TaskContent::Estimated {
                    step: STEP,
                    errors: vec![((2, 1), Some(number.into())), ((3, 0), None)],
                    data: vec![LinkDatum {
                        link: 0,
                        from: (2, 1),
                        bytes: Bytes(vec![0, 255, 7]),
                    }],
                    failure: None,
                },
            };
            let bytes = encode(&message).expect("a message");
            assert_eq!(decode::<TaskMessage>(&bytes).expect("the same"), message);
        }
        let number = f64::from(Number::from(f64::NAN));
        assert!(number.is_nan());
    }

    #[test]
    fn what_is_no_message_is_refused() {
        let datum = |bytes: &str| format!(r#"{{"link":0,"from":[0,0],"bytes":"{bytes}"}}"#);
        assert!(decode::<LinkDatum>(datum("AP8H").as_bytes()).is_ok());
        assert!(decode::<LinkDatum>(datum("?").as_bytes()).is_err());
        assert!(decode::<TaskContent>(br#"{"obey":{}}"#).is_err());
    }

    #[test]
    fn tasks_are_told_apart() {
        assert_eq!(fingerprint("one").len(), 16);
        assert_ne!(fingerprint("one"), fingerprint("other"));
    }
}
