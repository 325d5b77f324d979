//! Answers as a person reads them. What comes is another program's: a part that is missing or of
//! another kind is shown as it is, or not at all.

use container::control::Request;
use serde_json::{Map, Value};

use crate::commands::words::{parts, table, word};

/// Columns of the list: heading, and where in a verdict the text stands.
const COLUMNS: [(&str, &str); 6] = [
    ("ID", "id"),
    ("STATE", "state"),
    ("KIND", "kind"),
    ("COMPONENT", "component"),
    ("SEVERITY", "severity"),
    ("CAUSE", "cause"),
];

/// The answer to a request that was done.
pub(super) fn of(request: &Request, content: &Map<String, Value>) -> String {
    match request {
        Request::FaultList => list(content.get("faults")),
        Request::FaultShow { .. } => {
            let mut text = String::new();
            parts(&mut text, 0, content.get("fault").unwrap_or(&Value::Null));
            text
        }
        Request::FaultClear { .. } => cleared(content.get("cleared")),
        Request::FaultInject { .. } => {
            let number = content.get("injection").map_or_else(String::new, word);
            format!("injection {number} was accepted\n")
        }
        _ => String::new(),
    }
}

fn list(faults: Option<&Value>) -> String {
    let faults = faults.and_then(Value::as_array);
    let faults = faults.map(Vec::as_slice).unwrap_or_default();
    if faults.is_empty() {
        return "no faults\n".to_owned();
    }
    let headings = COLUMNS.map(|(heading, _)| heading.to_owned());
    let rows = faults.iter().map(|fault| {
        COLUMNS.map(|(_, key)| match key {
            "cause" => cause(&fault[key]),
            _ => word(&fault[key]),
        })
    });
    let rows: Vec<[String; COLUMNS.len()]> = std::iter::once(headings).chain(rows).collect();
    table(&rows, |_column| false)
}

fn cause(cause: &Value) -> String {
    match cause.get("consequence_of") {
        Some(id) => format!("of {}", word(id)),
        None => word(cause),
    }
}

fn cleared(ids: Option<&Value>) -> String {
    let ids = ids.and_then(Value::as_array);
    let ids: Vec<String> = ids.into_iter().flatten().map(word).collect();
    match ids.is_empty() {
        true => "nothing was to be cleared\n".to_owned(),
        false => format!("cleared {}\n", ids.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn text(request: &Request, content: Value) -> String {
        let Value::Object(content) = content else {
            panic!("no object");
        };
        of(request, &content)
    }

    #[test]
    fn a_list_has_columns() {
        let faults = json!({"faults": [
            {"id": 1, "state": "CONFIRMED", "kind": "segfault", "component": "camera",
             "severity": "reset", "cause": "root"},
            {"id": 12, "state": "HEALED", "kind": "stale", "component": "a\u{1b}[2J",
             "cause": {"consequence_of": 1}},
        ]});
        assert_eq!(
            text(&Request::FaultList, faults),
            "ID  STATE      KIND      COMPONENT  SEVERITY  CAUSE\n\
             1   CONFIRMED  segfault  camera     reset     root\n\
             12  HEALED     stale     a\u{FFFD}[2J                of 1\n"
        );
        assert_eq!(
            text(&Request::FaultList, json!({"faults": []})),
            "no faults\n"
        );
        assert_eq!(
            text(&Request::FaultList, json!({"faults": 7})),
            "no faults\n"
        );
    }

    #[test]
    fn a_fault_is_shown_with_all_its_parts() {
        let fault = json!({"fault": {
            "id": 1, "evidence": {"value": {"port": "range", "value": "NaN"}}, "plan": ["reset"],
            "actions": [],
        }});
        assert_eq!(
            text(&Request::FaultShow { id: 1 }, fault),
            "actions: []\nevidence:\n  value:\n    port: range\n    value: NaN\nid: 1\nplan:\n  \
             -: reset\n"
        );
    }

    #[test]
    fn what_was_done() {
        let clear = Request::FaultClear { id: None };
        assert_eq!(text(&clear, json!({"cleared": [1, 3]})), "cleared 1, 3\n");
        assert_eq!(text(&clear, json!({})), "nothing was to be cleared\n");
        let inject = Request::FaultInject {
            inject: container::control::protocol::Inject::Element(String::new()),
        };
        let accepted = text(&inject, json!({"injection": 4}));
        assert_eq!(accepted, "injection 4 was accepted\n");
    }
}
