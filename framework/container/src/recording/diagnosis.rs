//! How everybody fares, reckoned from the events: the same events give the same diagnostics.

use std::collections::{BTreeMap, BTreeSet};

use fault_manager::{FaultId, FaultState};
use recording::{DiagnosticArray, DiagnosticStatus, KeyValue, Level};

use crate::event_log::Event;

/// Name of the status that is about the recording itself.
const RECORDING: &str = "recording";

/// What is known of each component.
#[derive(Debug, Default)]
pub(super) struct Diagnosis {
    components: BTreeMap<String, Component>,
}

#[derive(Debug, Default, Clone)]
struct Component {
    application: String,
    state: &'static str,
    incarnation: u32,
    faults: u64,
    overruns: u64,
    last_fault: String,
    /// Faults that are confirmed and not over.
    open: BTreeSet<FaultId>,
}

impl Component {
    fn level(&self) -> Level {
        match self.state {
            "ERROR" => Level::Error,
            "ACTIVE" if self.open.is_empty() => Level::Ok,
            "ACTIVE" => Level::Warn,
            // It is not meant to work at the moment.
            _ => Level::Stale,
        }
    }

    fn status(&self, name: &str) -> DiagnosticStatus {
        let message = match self.level() {
            Level::Ok => self.state.to_owned(),
            _ if self.last_fault.is_empty() => self.state.to_owned(),
            _ => format!("{}: {}", self.state, self.last_fault),
        };
        DiagnosticStatus {
            level: self.level(),
            name: name.to_owned(),
            message,
            hardware_id: self.application.clone(),
            values: vec![
                KeyValue::new("state", self.state),
                KeyValue::new("incarnation", self.incarnation),
                KeyValue::new("faults", self.faults),
                KeyValue::new("overruns of its executor", self.overruns),
                KeyValue::new("last fault", &self.last_fault),
            ],
        }
    }
}

impl Diagnosis {
    /// Of components by their names, each with that of its application.
    pub(super) fn new<'name>(components: impl Iterator<Item = (&'name str, &'name str)>) -> Self {
        let unknown = |(name, application): (&str, &str)| {
            let component = Component {
                application: application.to_owned(),
                state: "CREATED",
                incarnation: 1,
                ..Component::default()
            };
            (name.to_owned(), component)
        };
        Self {
            components: components.map(unknown).collect(),
        }
    }

    /// Takes note of an event; whether somebody's level has changed by it.
    pub(super) fn learn(&mut self, event: &Event) -> bool {
        let name = match event {
            Event::State { component, .. } | Event::Fault { component, .. } => component,
            Event::Verdict(verdict) => &verdict.component,
            // An executor that only one component runs on bears its name.
            Event::Overrun { executor, .. } => executor,
            _ => return false,
        };
        let Some(component) = self.components.get_mut(name) else {
            return false;
        };
        let before = component.level();
        match event {
            Event::State {
                to, incarnation, ..
            } => {
                component.state = to;
                component.incarnation = *incarnation;
            }
            Event::Fault { kind, message, .. } => {
                component.last_fault = format!("{kind}: {message}");
            }
            Event::Overrun { .. } => component.overruns += 1,
            Event::Verdict(verdict) => match verdict.state {
                FaultState::Confirmed => {
                    if component.open.insert(verdict.id) {
                        component.faults += 1;
                        component.last_fault = verdict.kind.to_owned();
                    }
                }
                FaultState::Healed | FaultState::Cleared => {
                    component.open.remove(&verdict.id);
                }
                FaultState::Prefailed => {}
            },
            _ => {}
        }
        component.level() != before
    }

    /// The message of this moment; `messages` and `dropped` are those of the recording.
    pub(super) fn message(&self, time_ns: u64, messages: u64, dropped: u64) -> DiagnosticArray {
        let components = self.components.iter();
        let mut status: Vec<DiagnosticStatus> = components
            .map(|(name, component)| component.status(name))
            .collect();
        let (level, message) = match dropped {
            0 => (Level::Ok, "complete".to_owned()),
            _ => (Level::Warn, format!("{dropped} data were not recorded")),
        };
        status.push(DiagnosticStatus {
            level,
            name: RECORDING.to_owned(),
            message,
            hardware_id: String::new(),
            values: vec![
                KeyValue::new("messages", messages),
                KeyValue::new("dropped", dropped),
            ],
        });
        DiagnosticArray::new(time_ns, status)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(to: &'static str) -> Event {
        Event::State {
            component: "camera".to_owned(),
            from: "READY",
            to,
            incarnation: 2,
        }
    }

    fn fault(component: &str) -> Event {
        Event::Fault {
            component: component.to_owned(),
            incarnation: 2,
            kind: "panic",
            callback: "onExecute",
            message: "no picture".to_owned(),
            place: None,
            thread_lost: false,
        }
    }

    #[test]
    fn levels_follow_states() {
        let mut diagnosis = Diagnosis::new([("camera", "robot")].into_iter());
        for (event, changes, level, message) in [
            (state("READY"), false, Level::Stale, "READY"),
            (state("ACTIVE"), true, Level::Ok, "ACTIVE"),
            (fault("sonar"), false, Level::Ok, "ACTIVE"),
            (fault("camera"), false, Level::Ok, "ACTIVE"),
            (
                state("ERROR"),
                true,
                Level::Error,
                "ERROR: panic: no picture",
            ),
            (state("ACTIVE"), true, Level::Ok, "ACTIVE"),
            (
                state("INACTIVE"),
                true,
                Level::Stale,
                "INACTIVE: panic: no picture",
            ),
        ] {
            assert_eq!(diagnosis.learn(&event), changes, "{event:?}");
            let status = diagnosis.message(0, 0, 0).status;
            assert_eq!(
                (status[0].level, status[0].message.as_str()),
                (level, message)
            );
        }
    }

    #[test]
    fn what_was_not_recorded_is_said() {
        let status = Diagnosis::default().message(0, 10, 3).status;
        assert_eq!(status[0].level, Level::Warn);
        assert_eq!(status[0].values[1], KeyValue::new("dropped", 3));
    }
}
