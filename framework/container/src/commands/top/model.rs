//! What `steadfast top` shows: the last answers, what is chosen, and what keys change. No terminal, no
//! socket, no clock in here.

mod keys;

use std::time::Duration;

use serde_json::Value;

pub use keys::{Key, Wish};

/// Kinds of fault that can be chosen for injection, each as the attributes of its element: what needs
/// no more than a component. Everything else is for `steadfast fault inject`.
pub const INJECTIONS: [(&str, &str); 6] = [
    ("segfault", "fault=\"segfault\""),
    ("panic", "fault=\"panic\""),
    ("divide by zero", "fault=\"divide_by_zero\""),
    ("abort", "fault=\"abort\""),
    ("stack overflow", "fault=\"stack_overflow\""),
    ("hang", "fault=\"hang\""),
];

/// Faults of the feed that are kept: more than the tallest terminal shows.
const MOST_FAULTS: usize = 200;

/// Everything that the view is a function of.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// The last status; null before the first one.
    pub status: Value,
    /// Names of the components, in order.
    pub names: Vec<String>,
    /// Faults, the newest first.
    pub faults: Vec<Value>,
    /// Index of the component that is chosen.
    pub chosen: usize,
    /// What is in front of the table.
    pub dialog: Dialog,
    /// What came of the last key.
    pub message: String,
    /// Why there is no connection, and for how long; none while there is one.
    pub absence: Option<(String, Duration)>,
}

/// What is in front of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dialog {
    /// Nothing.
    #[default]
    None,
    /// The keys.
    Help,
    /// Whether the chosen component shall be stopped.
    Stop,
    /// Which fault shall be injected.
    Inject(usize),
}

impl Model {
    /// A status has come.
    pub fn take_status(&mut self, status: Value) {
        let chosen = self.chosen_name().map(str::to_owned);
        let components = status["components"].as_object();
        self.names = components
            .into_iter()
            .flatten()
            .map(|(name, _)| name.clone())
            .collect();
        self.status = status;
        self.absence = None;
        let same = |name: &String| Some(name) == chosen.as_ref();
        let found = self.names.iter().position(same);
        let last = self.names.len().saturating_sub(1);
        self.chosen = found.unwrap_or(self.chosen.min(last));
    }

    /// The list of faults has come, the oldest first.
    pub fn take_faults(&mut self, faults: Vec<Value>) {
        self.faults = faults.into_iter().rev().take(MOST_FAULTS).collect();
    }

    /// There is no connection.
    pub fn lose(&mut self, reason: String, absent: Duration) {
        self.absence = Some((reason, absent));
    }

    /// Name of the component that is chosen.
    pub fn chosen_name(&self) -> Option<&str> {
        self.names.get(self.chosen).map(String::as_str)
    }

    /// The newest fault that a clear would end: of the chosen component, else of any.
    pub fn fault_to_clear(&self) -> Option<u64> {
        let open = |fault: &&Value| matches!(fault["state"].as_str(), Some("CONFIRMED" | "HEALED"));
        let mut all = self.faults.iter().filter(open);
        let own = |fault: &&Value| fault["component"].as_str() == self.chosen_name();
        let fault = all.clone().find(own).or_else(|| all.next())?;
        fault["id"].as_u64()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn model(names: &[&str]) -> Model {
        let mut model = Model::default();
        let components = names.iter().map(|name| ((*name).to_owned(), json!({})));
        model.take_status(json!({"components": components.collect::<serde_json::Map<_, _>>()}));
        model
    }

    #[test]
    fn the_chosen_component_stays_chosen_when_others_come_and_go() {
        let mut chosen = model(&["a", "c", "e"]);
        chosen.chosen = 1;
        for (names, expected) in [
            (&["a", "b", "c"][..], Some("c")),
            (&["c"], Some("c")),
            (&["a", "b"], Some("a")),
            (&[], None),
        ] {
            chosen.take_status(model(names).status);
            assert_eq!(chosen.chosen_name(), expected, "{names:?}");
        }
    }

    #[test]
    fn the_fault_to_clear_is_the_newest_of_the_chosen_component() {
        let fault = |id: u64, component: &str, state: &str| json!({"id": id, "component": component, "state": state});
        for (chosen, faults, expected) in [
            (
                0,
                vec![fault(1, "a", "CONFIRMED"), fault(2, "b", "HEALED")],
                Some(1),
            ),
            (
                1,
                vec![fault(1, "a", "CONFIRMED"), fault(2, "b", "HEALED")],
                Some(2),
            ),
            (
                0,
                vec![fault(1, "a", "CLEARED"), fault(2, "b", "CONFIRMED")],
                Some(2),
            ),
            (0, vec![fault(1, "a", "CLEARED")], None),
            (0, vec![], None),
        ] {
            let mut model = model(&["a", "b"]);
            model.chosen = chosen;
            model.take_faults(faults.clone());
            assert_eq!(model.fault_to_clear(), expected, "{faults:?}");
        }
    }
}
