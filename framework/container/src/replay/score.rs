//! What is to be played, and when.

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use recording::{ReadError, read};
use system_model::specification::{ApplicationSpecification, Place};

use super::routes::find;
use super::state::{Due, RecordedVerdict, State};
use crate::assembly::{Assembly, AssemblyProblem};

/// A recording that is being played.
pub struct Score {
    place: Place,
    only: Option<String>,
    first_ns: u64,
    state: Mutex<State>,
}

impl std::fmt::Debug for Score {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Score")
            .field("place", &self.place)
            .field("only", &self.only)
            .finish_non_exhaustive()
    }
}

impl Score {
    /// Opens a recording. `only`: the component that is not played, but runs itself.
    ///
    /// # Errors
    /// If it is no recording, or holds no message.
    pub fn open(path: &Path, only: Option<String>) -> Result<Self, ReadError> {
        let mut reader = read(path)?;
        let next = reader.next().transpose()?;
        let first_ns = next.as_ref().map_or(0, |message| message.t_ns);
        Ok(Self {
            place: Place {
                file: path.to_owned(),
                ..Place::default()
            },
            only,
            first_ns,
            state: Mutex::new(State::new(reader, next, first_ns)),
        })
    }

    /// Whether the component of this name is played.
    pub fn plays(&self, component: &str) -> bool {
        self.only.as_deref() != Some(component)
    }

    /// Finds the port of every topic.
    ///
    /// # Errors
    /// If the recording does not fit the application, or there is no component to run itself.
    pub fn bind(
        &self,
        specification: &ApplicationSpecification,
        assembly: &Assembly,
    ) -> Result<(), Vec<AssemblyProblem>> {
        let names = || specification.components.iter().map(|it| it.name.as_str());
        if let Some(only) = &self.only
            && !names().any(|name| name == only)
        {
            return Err(vec![AssemblyProblem::Connection {
                place: Place {
                    file: specification.file.clone(),
                    ..Place::default()
                },
                message: format!("the application has no component '{only}' to be replayed"),
                help: format!(
                    "its components are {}",
                    names().collect::<Vec<_>>().join(", ")
                ),
            }]);
        }
        let mut state = self.state();
        let channels = state.reader.channels();
        let only = self.only.as_deref();
        let routes = find(&self.place, &channels, specification, assembly, only)?;
        let count = assembly.components.len();
        let mut has_topic = vec![false; count];
        for route in routes.by_topic.values() {
            has_topic[route.component()] = true;
        }
        state.readers = vec![Vec::new(); count];
        for connection in &specification.connections {
            let (source, target) = (connection.source.component, connection.target.component);
            if !has_topic[target] && !state.readers[source].contains(&target) {
                state.readers[source].push(target);
            }
        }
        state.due = (0..count).map(|_| Vec::new()).collect();
        state.cycles = vec![false; count];
        state.components = assembly.components.clone();
        state.routes = routes;
        Ok(())
    }

    /// When the recording begins, in nanoseconds of the container's clock at that time.
    pub fn first_ns(&self) -> u64 {
        self.first_ns
    }

    /// When the next message comes; none at the end.
    pub fn next_ns(&self) -> Option<u64> {
        let state = self.state();
        let next = state.next.as_ref().filter(|_| state.failure.is_none());
        next.map(|message| message.t_ns)
    }

    /// When the last message came that was released.
    pub fn last_ns(&self) -> u64 {
        self.state().last_ns
    }

    /// Releases all messages until now: data arrive, and components have a cycle in which they write
    /// theirs. `token`: of the thread that does so.
    pub fn release(&self, now_ns: u64, token: u32) {
        let mut state = self.state();
        while let Some(message) = state.next.take_if(|message| message.t_ns <= now_ns) {
            state.last_ns = state.last_ns.max(message.t_ns);
            let released = state.release(&message, token);
            let next = match released {
                Ok(()) => state.reader.next().transpose().map_err(|it| it.to_string()),
                Err(reason) => Err(format!(
                    "{}: topic '{}' at {:.6} s: {reason}\n  help: the file is damaged, or was \
                     changed; what comes before can be replayed after `mcap filter`",
                    self.place,
                    message.topic(),
                    Duration::from_nanos(message.t_ns).as_secs_f64(),
                )),
            };
            match next {
                Ok(next) => state.next = next,
                Err(reason) => state.failure = Some(reason),
            }
        }
    }

    /// Whether a component has a cycle now.
    pub fn has_cycle(&self, component: usize) -> bool {
        self.state().cycles.get(component).copied().unwrap_or(false)
    }

    /// A cycle of a component is over, also if it did not run.
    pub fn end_cycle(&self, component: usize) {
        let mut state = self.state();
        if let Some(cycle) = state.cycles.get_mut(component) {
            *cycle = false;
        }
        if let Some(due) = state.due.get_mut(component) {
            due.clear();
        }
    }

    /// What a component is to write in this cycle.
    pub(super) fn take(&self, component: usize) -> Vec<Due> {
        let mut state = self.state();
        state
            .due
            .get_mut(component)
            .map(std::mem::take)
            .unwrap_or_default()
    }

    /// Data of ports that were replayed so far.
    pub fn data(&self) -> u64 {
        self.state().data
    }

    /// Outputs of which the recording has nothing, and topics that the application does not have.
    pub fn gaps(&self) -> (Vec<String>, Vec<String>) {
        let state = self.state();
        (state.routes.missing.clone(), state.routes.strangers.clone())
    }

    /// The faults that were confirmed when it was recorded.
    pub fn verdicts(&self) -> Vec<RecordedVerdict> {
        self.state().verdicts.values().cloned().collect()
    }

    /// Whether the recording ends in its middle.
    pub fn was_cut(&self) -> bool {
        self.state().reader.was_cut()
    }

    /// Why it was not replayed to its end, if so.
    pub fn failure(&self) -> Option<String> {
        self.state().failure.clone()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
