//! Diagnostics in the form of ROS, as Foxglove's diagnostics panels read them:
//! `diagnostic_msgs/DiagnosticArray`.

use serde::{Deserialize, Serialize, Serializer};

/// Nanoseconds of a second.
const SECOND_NS: u64 = 1_000_000_000;

/// How a component fares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[repr(u8)]
pub enum Level {
    /// It works, and nothing is wrong.
    #[default]
    Ok = 0,
    /// It works, or will again; something was or is wrong.
    Warn = 1,
    /// It does not work.
    Error = 2,
    /// Nothing new is known of it.
    Stale = 3,
}

impl Serialize for Level {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(*self as u8)
    }
}

/// A time as ROS writes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Whole seconds.
    pub sec: u64,
    /// Nanoseconds behind them.
    pub nsec: u32,
}

impl Stamp {
    /// From nanoseconds.
    pub fn from_ns(time_ns: u64) -> Self {
        Self {
            sec: time_ns / SECOND_NS,
            // Below a thousand million.
            nsec: (time_ns % SECOND_NS) as u32,
        }
    }
}

/// One message of `/diagnostics`: how everybody fares.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosticArray {
    /// When.
    pub header: Header,
    /// One for each component.
    pub status: Vec<DiagnosticStatus>,
}

/// The header of a ROS message.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Header {
    /// By the container's clock.
    pub stamp: Stamp,
    /// Empty: a component is in no place.
    pub frame_id: &'static str,
}

/// How one component fares.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DiagnosticStatus {
    /// In a word.
    pub level: Level,
    /// Instance name.
    pub name: String,
    /// In words.
    pub message: String,
    /// Application of the component.
    pub hardware_id: String,
    /// In figures.
    pub values: Vec<KeyValue>,
}

/// One figure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyValue {
    /// What it is.
    pub key: String,
    /// The figure, as text.
    pub value: String,
}

impl KeyValue {
    /// A figure under its name.
    pub fn new(key: &str, value: impl ToString) -> Self {
        Self {
            key: key.to_owned(),
            value: value.to_string(),
        }
    }
}

impl DiagnosticArray {
    /// How everybody fares at this time.
    pub fn new(time_ns: u64, status: Vec<DiagnosticStatus>) -> Self {
        Self {
            header: Header {
                stamp: Stamp::from_ns(time_ns),
                frame_id: "",
            },
            status,
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn looks_like_the_message_of_ros() {
        let status = DiagnosticStatus {
            level: Level::Stale,
            name: "camera".to_owned(),
            message: "INACTIVE".to_owned(),
            hardware_id: "robot".to_owned(),
            values: vec![KeyValue::new("incarnation", 2)],
        };
        let array = DiagnosticArray::new(3 * SECOND_NS + 7, vec![status]);
        let expected = json!({
            "header": {"stamp": {"sec": 3, "nsec": 7}, "frame_id": ""},
            "status": [{
                "level": 3, "name": "camera", "message": "INACTIVE", "hardware_id": "robot",
                "values": [{"key": "incarnation", "value": "2"}],
            }],
        });
        assert_eq!(serde_json::to_value(array).unwrap(), expected);
    }
}
