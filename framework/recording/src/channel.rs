//! Topics and what is known of them.

use std::collections::BTreeMap;

use serde_json::{Value, json};

/// A topic of a recording, as a file tells of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Name: `/component/port`, or one of [`Topic`].
    pub topic: String,
    /// Name of the schema; for a port the name of its data type.
    pub schema: String,
    /// What else is known: of a port `component`, `port`, `direction` and `layout_hash`.
    pub metadata: BTreeMap<String, String>,
}

/// The topics that every recording has besides ports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Topic {
    /// `/events`: everything in the event log.
    Events,
    /// `/states`: life-cycle states of components.
    States,
    /// `/verdicts`: what the fault manager made of faults.
    Verdicts,
    /// `/diagnostics`: as `diagnostic_msgs/DiagnosticArray`.
    Diagnostics,
}

impl Topic {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Events,
        Self::States,
        Self::Verdicts,
        Self::Diagnostics,
    ];

    /// Its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Events => "/events",
            Self::States => "/states",
            Self::Verdicts => "/verdicts",
            Self::Diagnostics => "/diagnostics",
        }
    }

    /// The name of its schema.
    pub fn schema_name(self) -> &'static str {
        match self {
            Self::Events => "steadfast/Event",
            Self::States => "steadfast/State",
            Self::Verdicts => "steadfast/Verdict",
            Self::Diagnostics => "diagnostic_msgs/DiagnosticArray",
        }
    }

    /// Its schema as JSON Schema. Events and verdicts have further fields by their kind.
    pub fn schema(self) -> Value {
        let text = || json!({"type": "string"});
        let whole = || json!({"type": "integer"});
        match self {
            Self::Events => object(&[("t_ns", whole()), ("event", text())]),
            Self::States => object(&[
                ("component", text()),
                ("from", text()),
                ("to", text()),
                ("incarnation", whole()),
            ]),
            Self::Verdicts => object(&[
                ("id", whole()),
                ("state", text()),
                ("kind", text()),
                ("component", text()),
                ("severity", text()),
                ("first_symptom_ns", whole()),
                ("confirmed_ns", whole()),
                ("evidence", json!({"type": "object"})),
            ]),
            Self::Diagnostics => object(&[
                (
                    "header",
                    object(&[
                        ("stamp", object(&[("sec", whole()), ("nsec", whole())])),
                        ("frame_id", text()),
                    ]),
                ),
                (
                    "status",
                    array(object(&[
                        ("level", whole()),
                        ("name", text()),
                        ("message", text()),
                        ("hardware_id", text()),
                        (
                            "values",
                            array(object(&[("key", text()), ("value", text())])),
                        ),
                    ])),
                ),
            ]),
        }
    }
}

/// The schema of an object that has at least these properties.
fn object(properties: &[(&str, Value)]) -> Value {
    let required: Vec<&str> = properties.iter().map(|(name, _)| *name).collect();
    let named = properties.iter();
    let named = named.map(|(name, schema)| ((*name).to_owned(), schema.clone()));
    let properties: serde_json::Map<String, Value> = named.collect();
    json!({"type": "object", "properties": properties, "required": required})
}

fn array(items: Value) -> Value {
    json!({"type": "array", "items": items})
}
