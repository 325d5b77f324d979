//! A diagram for programs.

use serde_json::json;

use super::diagram::Diagram;

/// `title`, `nodes`, `edges`, `executors`; indices are those of nodes.
pub fn text(diagram: &Diagram) -> String {
    format!("{:#}\n", json!(diagram))
}
