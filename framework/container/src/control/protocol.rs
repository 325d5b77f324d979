//! What is said over the socket: one JSON object a line.
//!
//! | request | answer, if all is well |
//! |---|---|
//! | `{"request":"status"}` | `{"ok":true,"status":{…}}` |
//! | `{"request":"component_list"}` | `{"ok":true,"components":{"camera":{…}, …}}` |
//! | `{"request":"component_info","component":"camera"}` | `{"ok":true,"component":{…}}` |
//! | `{"request":"component_reset","component":"camera"}` | `{"ok":true,"ordered":3}` |
//! | `{"request":"component_replace","component":"camera","with":"spare"}`, `"with":null` for the next secondary | `{"ok":true,"ordered":3}` |
//! | `{"request":"component_stop","component":"camera"}` | `{"ok":true,"ordered":3}` |
//! | `{"request":"fault_list"}` | `{"ok":true,"faults":[verdict, …]}` |
//! | `{"request":"fault_show","id":3}` | `{"ok":true,"fault":verdict}` |
//! | `{"request":"fault_clear","id":3}`, `"id":null` for all | `{"ok":true,"cleared":[3]}` |
//! | `{"request":"fault_inject","inject":"<inject …/>"}` | `{"ok":true,"injection":0}` |
//!
//! `ordered` is the number of the verdict that tells what becomes of the order: it was carried out when
//! that has `handling_us`. `inject` may also be an object of the element's attributes. A refusal is
//! `{"ok":false,"error":"why"}`.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// A longer request is none: the longest sensible one, an injection with every attribute, has some
/// hundred bytes.
pub const MAX_REQUEST_BYTES: usize = 16 * 1024;

/// A longer answer is not read: a list of faults with a page of evidence each would hold thousands.
pub const MAX_ANSWER_BYTES: usize = 16 * 1024 * 1024;

/// What a client wants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "request", rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// How the system is.
    Status,
    /// How its components are.
    ComponentList,
    /// Everything about one component.
    ComponentInfo {
        /// Its name.
        component: String,
    },
    /// Resets a component; one that was stopped works again by that.
    ComponentReset {
        /// Its name.
        component: String,
    },
    /// Puts a secondary in a component's place.
    ComponentReplace {
        /// Its name.
        component: String,
        /// Component type of the secondary; `None`: the next one.
        with: Option<String>,
    },
    /// Stops a component, and what needs it.
    ComponentStop {
        /// Its name.
        component: String,
    },
    /// All faults, the newest verdict of each.
    FaultList,
    /// One fault.
    FaultShow {
        /// Its number.
        id: u64,
    },
    /// Ends faults that have healed or are latched.
    FaultClear {
        /// Which one; `None`: all, and the emergency stop.
        id: Option<u64>,
    },
    /// Makes something go wrong.
    FaultInject {
        /// What.
        inject: Inject,
    },
}

/// One injection, as its element or as the attributes of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Inject {
    /// `<inject component="camera" fault="hang"/>`
    Element(String),
    /// `{"component":"camera","fault":"hang"}`; values are texts or numbers.
    Attributes(BTreeMap<String, Value>),
}

/// What a client is told.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// It was done; the object says what came of it, by the keys of the table above.
    Done(Map<String, Value>),
    /// It was not done, and why.
    Refused(String),
}

impl Request {
    /// Reads a line.
    ///
    /// # Errors
    /// If it is no request: why, for the client.
    pub fn from_line(line: &[u8]) -> Result<Self, String> {
        serde_json::from_slice(line).map_err(|error| format!("this is no request: {error}"))
    }

    /// The line, with its end.
    ///
    /// # Errors
    /// None that a request can cause; the library reserves them.
    pub fn to_line(&self) -> serde_json::Result<Vec<u8>> {
        let mut line = serde_json::to_vec(self)?;
        line.push(b'\n');
        Ok(line)
    }
}

impl Inject {
    /// The element, to be read by `system_profile::read_injection`.
    ///
    /// # Errors
    /// If an attribute has no sensible name, or a value that is neither text nor number.
    pub fn element(&self) -> Result<String, String> {
        let attributes = match self {
            Self::Element(text) => return Ok(text.clone()),
            Self::Attributes(attributes) => attributes,
        };
        let mut element = "<inject".to_owned();
        for (name, value) in attributes {
            let sensible = |letter: char| letter.is_ascii_lowercase() || letter == '_';
            if name.is_empty() || !name.chars().all(sensible) {
                return Err(format!("{name:?} is no attribute of an injection"));
            }
            let text = match value {
                Value::String(text) => escaped(text),
                Value::Number(number) => number.to_string(),
                _ => return Err(format!("{name} is neither a text nor a number")),
            };
            // Writing to a text does not fail.
            let _infallible = write!(element, " {name}=\"{text}\"");
        }
        Ok(element + "/>")
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

impl Answer {
    /// Done, with one result of this key.
    pub fn done(key: &str, result: impl Into<Value>) -> Self {
        Self::Done(Map::from_iter([(key.to_owned(), result.into())]))
    }

    /// As a JSON object.
    pub fn to_json(&self) -> Value {
        match self {
            Self::Done(content) => {
                let mut content = content.clone();
                content.insert("ok".into(), json!(true));
                Value::Object(content)
            }
            Self::Refused(error) => json!({"ok": false, "error": error}),
        }
    }

    /// The line, with its end.
    pub fn to_line(&self) -> Vec<u8> {
        let mut line = self.to_json().to_string().into_bytes();
        line.push(b'\n');
        line
    }

    /// Reads a line; none if it is no answer.
    pub fn from_line(line: &[u8]) -> Option<Self> {
        let mut content: Map<String, Value> = serde_json::from_slice(line).ok()?;
        match content.remove("ok")? {
            Value::Bool(true) => Some(Self::Done(content)),
            Value::Bool(false) => {
                let error = content.get("error")?.as_str()?;
                Some(Self::Refused(error.to_owned()))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_what_the_table_says() {
        let inject = Inject::Element("<inject/>".into());
        let component = || "camera".to_owned();
        for (line, request) in [
            (r#"{"request":"status"}"#, Request::Status),
            (r#"{"request":"component_list"}"#, Request::ComponentList),
            (
                r#"{"request":"component_info","component":"camera"}"#,
                Request::ComponentInfo {
                    component: component(),
                },
            ),
            (
                r#"{"request":"component_reset","component":"camera"}"#,
                Request::ComponentReset {
                    component: component(),
                },
            ),
            (
                r#"{"request":"component_replace","component":"camera","with":null}"#,
                Request::ComponentReplace {
                    component: component(),
                    with: None,
                },
            ),
            (
                r#"{"request":"component_stop","component":"camera"}"#,
                Request::ComponentStop {
                    component: component(),
                },
            ),
            (r#"{"request":"fault_list"}"#, Request::FaultList),
            (
                r#"{"request":"fault_show","id":3}"#,
                Request::FaultShow { id: 3 },
            ),
            (
                r#"{"request":"fault_clear","id":null}"#,
                Request::FaultClear { id: None },
            ),
            (
                r#"{"request":"fault_inject","inject":"<inject/>"}"#,
                Request::FaultInject { inject },
            ),
        ] {
            assert_eq!(Request::from_line(line.as_bytes()), Ok(request.clone()));
            assert_eq!(request.to_line().unwrap(), format!("{line}\n").as_bytes());
        }
        for line in [
            "",
            "[]",
            "{}",
            "{\"request\":\"reboot\"}",
            "{\"request\":\"fault_show\"}",
            "{\"request\":\"fault_show\",\"id\":-1}",
            "{\"request\":\"fault_show\",\"id\":1,\"please\":true}",
            "{\"request\":\"fault_inject\",\"inject\":3}",
            "\u{feff}{\"request\":\"status\"}",
        ] {
            assert!(Request::from_line(line.as_bytes()).is_err(), "{line}");
        }
        assert!(Request::from_line(&[b'{', 0xff, 0xfe]).is_err());
    }

    #[test]
    fn attributes_become_an_element() {
        let element = |attributes: Value| {
            let inject: Inject = serde_json::from_value(attributes).unwrap();
            inject.element()
        };
        assert_eq!(
            element(json!({"component": "a<&\">b", "fault": "exit", "code": 3})),
            Ok("<inject code=\"3\" component=\"a&lt;&amp;&quot;>b\" fault=\"exit\"/>".into())
        );
        assert_eq!(element(json!("<inject/>")), Ok("<inject/>".into()));
        for wrong in [json!({"a b": "c"}), json!({"": "c"}), json!({"code": [1]})] {
            assert!(element(wrong.clone()).is_err(), "{wrong}");
        }
    }

    #[test]
    fn answers_come_through() {
        for answer in [
            Answer::done("faults", json!([])),
            Answer::Refused("no fault 7\n\"really\"".into()),
        ] {
            let line = answer.to_line();
            assert_eq!(line.iter().filter(|byte| **byte == b'\n').count(), 1);
            assert_eq!(Answer::from_line(&line), Some(answer));
        }
        for line in ["", "{}", "{\"ok\":1}", "{\"ok\":false}", "garbage"] {
            assert_eq!(Answer::from_line(line.as_bytes()), None, "{line}");
        }
    }
}
