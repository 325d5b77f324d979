//! What was seen of a fault.

use serde::Serialize;

/// What was seen, for the verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// A runtime exception, a hang, a failure returned or reported.
    Exception {
        /// Callback, as OPRoS names it.
        callback: String,
        /// What was seen, in words.
        message: String,
        /// `file:line:column` in the component's source.
        #[serde(skip_serializing_if = "Option::is_none")]
        place: Option<String>,
        /// Name of the signal.
        #[serde(skip_serializing_if = "Option::is_none")]
        signal: Option<String>,
        /// `si_addr` as hexadecimal number, where it is the same in every run or time is real.
        #[serde(skip_serializing_if = "Option::is_none")]
        address: Option<String>,
        /// Frames of the component, innermost first.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        backtrace: Vec<String>,
        /// Whether the thread was lost with the component.
        thread_lost: bool,
        /// What it may have done to others in the same process, and which isolation tier would have
        /// contained it.
        #[serde(skip_serializing_if = "Option::is_none")]
        damage: Option<&'static str>,
    },
    /// A value of a port and its limits.
    Value {
        /// Port.
        port: String,
        /// Field.
        field: String,
        /// The value.
        value: Number,
        /// Least value allowed.
        #[serde(skip_serializing_if = "Option::is_none")]
        minimum: Option<f64>,
        /// Largest value allowed.
        #[serde(skip_serializing_if = "Option::is_none")]
        maximum: Option<f64>,
    },
    /// A value that jumped.
    Jump {
        /// Port.
        port: String,
        /// Field.
        field: String,
        /// The value.
        value: Number,
        /// How fast it changed, per second.
        rate: Number,
        /// Largest rate allowed.
        maximum_per_second: f64,
    },
    /// Values that do not change.
    Frozen {
        /// Port.
        port: String,
        /// Field; empty for the whole datum.
        field: String,
        /// So many equal data.
        count: u32,
    },
    /// A datum of the wrong size.
    Size {
        /// Port.
        port: String,
        /// Bytes that came.
        size: usize,
        /// Bytes that the type has.
        expected: usize,
    },
    /// An input without new data.
    Age {
        /// Port.
        port: String,
        /// Age of the newest datum in milliseconds.
        age_ms: f64,
        /// Largest age allowed.
        maximum_ms: f64,
    },
    /// Cycles that took too long.
    Overruns {
        /// How many.
        count: u64,
        /// How many are tolerated.
        tolerated: u32,
        /// Within which time.
        within_ms: f64,
    },
    /// Work that was not completed.
    Heartbeat {
        /// Periods without work.
        missed: u32,
        /// Length of a period.
        period_ms: f64,
    },
    /// Memory that was allocated and not freed.
    Memory {
        /// So much, in kilobytes, rounded up.
        used_kb: u64,
        /// So much is allowed.
        limit_kb: u64,
    },
    /// A residual of a process model.
    Residual {
        /// Monitor.
        monitor: String,
        /// Decision rule.
        method: String,
        /// What was measured minus what the model says.
        residual: Number,
        /// What the decision rule made of it.
        statistic: Number,
        /// What it is compared with.
        threshold: f64,
    },
    /// Nothing: an operator ordered it, or a behaviour tree.
    Order {
        /// What, in words.
        order: String,
        /// The tree; none for an operator.
        #[serde(skip_serializing_if = "Option::is_none")]
        by: Option<String>,
    },
    /// A vote.
    Votes {
        /// Voter.
        voter: String,
        /// What this source said.
        value: Number,
        /// What was voted.
        voted: Number,
        /// How far a source may be off.
        tolerance: f64,
        /// What all sources said, in their order; null for a source that said nothing usable.
        votes: Vec<Option<Number>>,
    },
}

/// A number that may be no number: JSON has none for NaN and the infinities, they are written as
/// text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number(pub f64);

impl Serialize for Number {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() {
            serializer.serialize_f64(self.0)
        } else {
            serializer.collect_str(&self.0)
        }
    }
}
