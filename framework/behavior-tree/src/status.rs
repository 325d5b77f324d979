//! What a node answers.

use std::fmt;

/// What a node has come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Status {
    /// Not at work: it has not begun, or was halted. No node ever answers this.
    #[default]
    Idle,
    /// It has begun and needs more ticks.
    Running,
    /// It has reached what it is for.
    Success,
    /// It has not.
    Failure,
    /// It was passed over; for its parent it is as if it were not there.
    Skipped,
}

impl Status {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Idle,
        Self::Running,
        Self::Success,
        Self::Failure,
        Self::Skipped,
    ];

    /// The word in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Idle => "IDLE",
            Self::Running => "RUNNING",
            Self::Success => "SUCCESS",
            Self::Failure => "FAILURE",
            Self::Skipped => "SKIPPED",
        }
    }

    /// The status of a word in capitals.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|status| status.name() == word)
    }

    /// Whether the node has ended by itself.
    pub fn is_completed(self) -> bool {
        matches!(self, Self::Success | Self::Failure)
    }
}

impl fmt::Display for Status {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}
