//! What a verdict says was seen: in a sentence, as something to draw, and what a recording may have
//! of it.

mod kinds;

use super::model::Verdict;
use kinds::{Fields, exception, of_port, of_work, residual, votes};

/// The evidence of a fault.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Evidence {
    /// What was seen.
    pub(super) seen: String,
    /// What else is known of it, line by line: frames of a backtrace, possible damage.
    pub(super) notes: Vec<String>,
    /// What can be drawn of it without a recording.
    pub(super) drawing: Option<Drawing>,
    /// What a recording may have of it.
    pub(super) wanted: Option<Wanted>,
}

/// What can be drawn of a verdict alone.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Drawing {
    /// A quantity and its limits.
    Level(Level),
    /// What sources said: each vote, what was voted, how far a vote may be off.
    Votes {
        votes: Vec<Option<f64>>,
        dissent: f64,
        voted: f64,
        tolerance: f64,
    },
}

/// A quantity and its limits.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Level {
    /// What it is, with its unit: `age in ms`.
    pub(super) quantity: String,
    pub(super) value: f64,
    pub(super) minimum: Option<f64>,
    pub(super) maximum: Option<f64>,
}

/// What is to be looked for in a recording.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Wanted {
    /// The topic.
    pub(super) topic: String,
    /// The field, as descriptors name it: `pose.x`, `distances[2]`.
    pub(super) field: String,
    /// What is drawn of it.
    pub(super) kind: WantedKind,
}

/// What is drawn of recorded data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum WantedKind {
    /// The field itself.
    Value,
    /// The age of the newest datum in milliseconds.
    Age,
}

/// Reads the evidence of a verdict. What is of no known kind is shown as it stands.
pub(super) fn evidence(verdict: &Verdict) -> Evidence {
    let known = verdict.evidence.as_object().and_then(|it| it.iter().next());
    let Some((kind, value)) = known else {
        return Evidence {
            seen: format!("{} was reported", verdict.kind.replace('_', " ")),
            ..Evidence::default()
        };
    };
    let fields = Fields(value);
    let component = verdict.component.as_str();
    match kind.as_str() {
        "exception" => exception(&fields),
        "value" | "jump" | "frozen" | "size" | "age" => of_port(kind, &fields, component),
        "residual" => residual(&fields, component),
        "votes" => votes(&fields),
        "overruns" | "heartbeat" | "memory" => of_work(kind, &fields),
        "order" => Evidence {
            seen: match fields.text("by").as_str() {
                "" => format!("an operator ordered it: {}", fields.text("order")),
                tree => format!("tree {tree} ordered it: {}", fields.text("order")),
            },
            ..Evidence::default()
        },
        other => Evidence {
            seen: format!("{other}: {value}"),
            ..Evidence::default()
        },
    }
}

#[cfg(test)]
mod tests;
