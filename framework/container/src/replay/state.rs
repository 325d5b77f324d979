//! How far a recording is played.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use recording::{Message, Reader, Topic};
use serde::Serialize;
use serde_json::Value;
use system_model::specification::PortKind;

use super::routes::{Route, Routes};
use crate::component::ComponentCell;

/// A datum that a component is to write.
#[derive(Debug)]
pub(super) struct Due {
    pub(super) port: u32,
    pub(super) kind: PortKind,
    pub(super) datum: Vec<u8>,
}

/// A fault as the recording has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordedVerdict {
    /// Its number in that run.
    pub id: u64,
    /// The component that was to blame.
    pub component: String,
    /// Kind of fault.
    pub kind: String,
    /// When it was confirmed.
    pub confirmed_ns: u64,
}

/// How far it is.
pub(super) struct State {
    pub(super) reader: Reader,
    pub(super) next: Option<Message>,
    pub(super) routes: Routes,
    pub(super) components: Vec<Arc<ComponentCell>>,
    /// By component: what it is to write in its next cycle.
    pub(super) due: Vec<Vec<Due>>,
    /// By component: whether it has a cycle now.
    pub(super) cycles: Vec<bool>,
    /// By component: those that have nothing in the recording and read what it writes.
    pub(super) readers: Vec<Vec<usize>>,
    pub(super) incarnations: BTreeMap<String, u64>,
    pub(super) verdicts: BTreeMap<u64, RecordedVerdict>,
    pub(super) data: u64,
    pub(super) last_ns: u64,
    pub(super) failure: Option<String>,
}

impl Route {
    /// The component that it is about.
    pub(super) fn component(&self) -> usize {
        match self {
            Self::Written { component, .. } | Self::Arriving { component, .. } => *component,
        }
    }
}

impl State {
    /// With nothing played.
    pub(super) fn new(reader: Reader, next: Option<Message>, first_ns: u64) -> Self {
        Self {
            reader,
            next,
            routes: Routes::default(),
            components: Vec::new(),
            due: Vec::new(),
            cycles: Vec::new(),
            readers: Vec::new(),
            incarnations: BTreeMap::new(),
            verdicts: BTreeMap::new(),
            data: 0,
            last_ns: first_ns,
            failure: None,
        }
    }

    /// Releases one message.
    pub(super) fn release(&mut self, message: &Message, token: u32) -> Result<(), String> {
        let topic = message.topic();
        if topic == Topic::Verdicts.name() {
            self.note(&message.value);
        } else if topic == Topic::States.name() {
            self.begin_anew(&message.value, token);
        }
        let Some(route) = self.routes.by_topic.get_mut(topic) else {
            return Ok(());
        };
        let component = route.component();
        self.data += 1;
        self.cycles[component] = true;
        match route {
            Route::Written {
                port, kind, layout, ..
            } => {
                let mut datum = vec![0; layout.data_type().size];
                layout
                    .decode(&message.value, &mut datum)
                    .map_err(|misfit| misfit.to_string())?;
                let due = Due {
                    port: *port,
                    kind: *kind,
                    datum,
                };
                self.due[component].push(due);
                for reader in &self.readers[component] {
                    self.cycles[*reader] = true;
                }
            }
            Route::Arriving {
                layout,
                sender,
                wake,
                ..
            } => {
                let mut decoded = Ok(());
                sender.send(message.publish_ns, u32::MAX, |datum| {
                    decoded = layout.decode(&message.value, datum);
                    decoded.is_ok()
                });
                decoded.map_err(|misfit| misfit.to_string())?;
                if let Some(wake) = wake {
                    wake.wake();
                }
            }
        }
        Ok(())
    }

    /// Notes a verdict of the recorded run.
    fn note(&mut self, verdict: &Value) {
        let text = |key: &str| verdict[key].as_str().unwrap_or_default().to_owned();
        let number = |key: &str| verdict[key].as_u64().unwrap_or_default();
        if verdict["state"] == "PREFAILED" {
            return;
        }
        let recorded = RecordedVerdict {
            id: number("id"),
            component: text("component"),
            kind: text("kind"),
            confirmed_ns: number("confirmed_ns"),
        };
        self.verdicts.insert(recorded.id, recorded);
    }

    /// Another incarnation writes from now on: what is compared with earlier data begins anew.
    fn begin_anew(&mut self, state: &Value, token: u32) {
        let (Some(name), Some(incarnation)) =
            (state["component"].as_str(), state["incarnation"].as_u64())
        else {
            return;
        };
        let before = self.incarnations.insert(name.to_owned(), incarnation);
        if before.is_none_or(|before| before == incarnation) {
            return;
        }
        for cell in &self.components {
            if let Some(mut component) = cell.enter(token, Duration::ZERO)
                && component.name().as_ref() == name
            {
                component.services_mut().begin_taps_anew();
            }
        }
    }
}
