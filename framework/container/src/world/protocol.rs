//! What a container asks of a world in another process. Answers come in the order of the questions.

use std::path::PathBuf;
use std::time::Duration;

use robot_simulation::{Fault, RobotSummary};
use serde::{Deserialize, Serialize};

/// A world answers within one of its steps, which takes microseconds; a picture takes longer to
/// draw. After this a world is taken for hung.
pub(super) const ANSWER_LIMIT: Duration = Duration::from_secs(2);

/// A question or command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Request {
    /// How the drive went so far.
    Summary,
    /// A picture of it.
    Picture,
    /// Open this device.
    Open(String),
    /// Make a fault of the hardware appear.
    SetFault(Fault),
    /// Take it away.
    ClearFault(Fault),
}

/// An answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Answer {
    /// How the drive went.
    Summary(RobotSummary),
    /// As SVG.
    Picture(String),
    /// The descriptor comes along; the device's file, if it has one.
    Opened(Option<PathBuf>),
    /// So it is.
    Done,
    /// Why not.
    Refused(String),
}
