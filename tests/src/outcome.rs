//! What a run came to: exit code, events, summary.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::watchdog::Finished;

/// What a run came to.
pub struct Outcome {
    finished: Finished,
    raw_events: String,
    events: Vec<Value>,
    summary: Value,
}

impl Outcome {
    pub(crate) fn new(finished: Finished, raw_events: String, summary: Option<String>) -> Self {
        // A container that was killed leaves half a line.
        let events = raw_events
            .split_inclusive('\n')
            .filter(|line| line.ends_with('\n'))
            .map(|line| {
                serde_json::from_str(line)
                    .unwrap_or_else(|error| panic!("not JSON: {line}: {error}\n{finished}"))
            })
            .collect();
        let summary = summary.map_or(Value::Null, |text| {
            serde_json::from_str(&text).expect("the summary is JSON")
        });
        Self {
            finished,
            raw_events,
            events,
            summary,
        }
    }

    /// It ended well.
    ///
    /// # Panics
    /// If not.
    #[must_use]
    pub fn ended_well(self) -> Self {
        assert_eq!(self.finished.code, Some(0), "{}", self.finished);
        self
    }

    /// It was refused with this exit code, each of these words on the error output, and no callback
    /// of any component has started it.
    ///
    /// # Panics
    /// If not.
    pub fn was_refused(&self, code: i32, words: &[&str]) {
        self.was_refused_after(code, words);
        assert!(
            !self.raw_events.contains("\"to\":\"ACTIVE\""),
            "nothing may have been started: {}",
            self.raw_events
        );
    }

    /// As [`Self::was_refused`], by a component that said no when others had said yes.
    ///
    /// # Panics
    /// If not.
    pub fn was_refused_after(&self, code: i32, words: &[&str]) {
        assert_eq!(self.finished.code, Some(code), "{}", self.finished);
        for word in words {
            assert!(
                self.finished.stderr.contains(word),
                "'{word}' is not in it: {}",
                self.finished
            );
        }
        assert!(
            !self.raw_events.contains("onExecute"),
            "nothing may have run: {}",
            self.raw_events
        );
        assert_eq!(self.summary, Value::Null, "nothing ran");
    }

    /// The summary as it is.
    pub fn summary(&self) -> &Value {
        &self.summary
    }

    /// Exit code and output.
    pub fn finished(&self) -> &Finished {
        &self.finished
    }

    /// The event file as it is.
    pub fn raw_events(&self) -> &str {
        &self.raw_events
    }

    /// All events of one kind, of one component.
    pub fn events(&self, kind: &str, component: &str) -> Vec<&Value> {
        self.events
            .iter()
            .filter(|event| event["event"] == kind && event["component"] == component)
            .collect()
    }

    /// All events in order.
    pub fn all_events(&self) -> &[Value] {
        &self.events
    }

    /// Faults of a component, as kind and callback.
    pub fn faults(&self, component: &str) -> Vec<(String, String)> {
        self.events("fault", component)
            .into_iter()
            .map(|event| (text(&event["kind"]), text(&event["callback"])))
            .collect()
    }

    /// What the fault manager made of each fault in the end, in the order of their numbers.
    pub fn verdicts(&self) -> Vec<&Value> {
        let mut last = BTreeMap::new();
        for event in self.events.iter().filter(|it| it["event"] == "verdict") {
            last.insert(event["id"].as_u64(), event);
        }
        last.into_values().collect()
    }

    /// Everything that was done about faults, and how it ended: `reset counter: done`.
    pub fn actions(&self) -> Vec<String> {
        let actions = |verdict: &&Value| {
            let actions = verdict["actions"].as_array().cloned();
            actions.unwrap_or_default()
        };
        let words = |action: Value| {
            let (what, outcome) = (text(&action["action"]), text(&action["outcome"]));
            format!("{what}: {outcome}")
        };
        let verdicts = self.verdicts();
        verdicts.iter().flat_map(actions).map(words).collect()
    }

    /// What is to be known of the actions that have a note, in order.
    pub fn notes(&self) -> Vec<String> {
        let verdicts = self.verdicts();
        let actions = verdicts.iter().filter_map(|it| it["actions"].as_array());
        let noted = actions
            .flatten()
            .filter(|action| action["note"].is_string());
        noted.map(|action| text(&action["note"])).collect()
    }

    /// States that a component entered.
    pub fn states(&self, component: &str) -> Vec<String> {
        self.events("state", component)
            .into_iter()
            .map(|event| text(&event["to"]))
            .collect()
    }

    /// What a component logged.
    pub fn logs(&self, component: &str) -> Vec<String> {
        self.events("log", component)
            .into_iter()
            .map(|event| text(&event["message"]))
            .collect()
    }

    /// A component in the summary.
    ///
    /// # Panics
    /// If it is not there.
    pub fn component(&self, name: &str) -> &Value {
        let component = &self.summary["components"][name];
        assert!(component.is_object(), "no '{name}' in {}", self.summary);
        component
    }

    /// Completed `onExecute` of a component.
    ///
    /// # Panics
    /// If the summary does not tell.
    pub fn cycles(&self, name: &str) -> u64 {
        self.component(name)["cycles"].as_u64().expect("a number")
    }

    /// The application in the summary.
    pub fn application(&self) -> &Value {
        &self.summary["applications"]["application"]
    }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}
