//! A running system under an operator's control.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use fault_manager::{FaultId, FaultState, Observation, Verdict};
use serde::Serialize;
use system_model::injection::{InjectedFault, Injection};
use system_model::specification::ApplicationSpecification;
use system_profile::{Problem, Severity, read_injection};

use super::Control;
use super::ordering::{ORDER_LIMIT, Wanted};
use super::protocol::{Answer, Inject, Request};
use crate::assembly::Link;
use crate::library::PortDescription;
use crate::mission::TreeStatus;
use crate::status::{ComponentStatus, Meter};
use crate::supervision::Supervisor;

/// What an injection that comes over the socket is called in problems.
const REQUEST: &str = "the injection";

/// A running system.
pub struct RunningSystem {
    /// What runs: all components, by the names that requests use.
    pub specification: ApplicationSpecification,
    /// The name of each application, and its components.
    pub applications: Vec<(String, Range<usize>)>,
    /// The ports of each component, as its library describes them.
    pub interfaces: Arc<[Vec<PortDescription>]>,
    /// What the container knows of each component.
    pub statuses: Vec<Arc<ComponentStatus>>,
    /// What is known of each behaviour tree.
    pub trees: Vec<Arc<TreeStatus>>,
    /// The fault manager's shell.
    pub supervisor: Arc<Supervisor>,
    /// How often components work, and how long that takes.
    pub meter: Arc<Meter>,
    /// The connections of data ports.
    pub links: Arc<[Link]>,
    /// When the container was started.
    pub began: Instant,
    /// How often it was restarted by the parent that supervises it.
    pub restarts: u32,
}

impl Control for RunningSystem {
    fn handle(&self, request: Request) -> Answer {
        match request {
            Request::Status => answer("status", &self.view()),
            Request::ComponentList => answer("components", &self.view().components),
            Request::ComponentInfo { component } => match self.find(&component) {
                Ok(index) => answer("component", &self.info(index)),
                Err(reason) => Answer::Refused(reason),
            },
            Request::ComponentReset { component } => self.order(&component, &Wanted::Reset),
            Request::ComponentReplace { component, with } => {
                self.order(&component, &Wanted::Replacement(with))
            }
            Request::ComponentStop { component } => self.order(&component, &Wanted::Stop),
            Request::FaultList => answer("faults", &self.supervisor.verdicts()),
            Request::FaultShow { id } => match self.verdict(id) {
                Some(verdict) => answer("fault", &verdict),
                None => unknown(id),
            },
            Request::FaultClear { id } => self.clear(id),
            Request::FaultInject { inject } => self.inject(&inject),
        }
    }
}

/// A result as the only part of an answer.
fn answer(key: &str, result: &impl Serialize) -> Answer {
    match serde_json::to_value(result) {
        Ok(value) => Answer::done(key, value),
        Err(error) => Answer::Refused(format!("the answer cannot be written: {error}")),
    }
}

fn unknown(id: u64) -> Answer {
    Answer::Refused(format!(
        "there is no fault {id}; 'steadfast fault list' names them"
    ))
}

impl RunningSystem {
    fn verdict(&self, id: u64) -> Option<Verdict> {
        let mut verdicts = self.supervisor.verdicts().into_iter();
        verdicts.find(|verdict| verdict.id.0 == id)
    }

    fn clear(&self, id: Option<u64>) -> Answer {
        let before = match id {
            None => self.supervisor.verdicts(),
            Some(number) => match self.verdict(number) {
                None => return unknown(number),
                Some(verdict) => vec![verdict],
            },
        };
        let observation = Observation::Clear(id.map(FaultId));
        if !self.supervisor.tell(observation, ORDER_LIMIT) {
            return Answer::Refused("the fault manager is busy; it will be done later".into());
        }
        let after = self.supervisor.verdicts();
        let open = |id: FaultId| {
            let mut open = after.iter().filter(|it| it.state != FaultState::Cleared);
            open.any(|verdict| verdict.id == id)
        };
        let were_open = before.iter().filter(|it| it.state != FaultState::Cleared);
        let (open, cleared): (Vec<u64>, Vec<u64>) = were_open
            .map(|verdict| verdict.id.0)
            .partition(|id| open(FaultId(*id)));
        match (id, open.is_empty()) {
            (Some(id), false) => Answer::Refused(format!(
                "fault {id} is still being handled; when that is over it heals by itself"
            )),
            _ => Answer::done("cleared", cleared),
        }
    }

    fn inject(&self, inject: &Inject) -> Answer {
        let read = inject.element().and_then(|text| self.read(&text));
        match read.and_then(|injection| self.arm(injection)) {
            Ok(number) => Answer::done("injection", number),
            Err(reason) => Answer::Refused(reason),
        }
    }

    fn read(&self, text: &str) -> Result<Injection, String> {
        let outcome = read_injection(&self.specification, REQUEST, text);
        let injection = outcome.injections.and_then(|all| all.into_iter().next());
        injection.ok_or_else(|| {
            let errors = outcome.problems.iter();
            let errors = errors.filter(|problem| problem.severity == Severity::Error);
            errors.map(words).collect::<Vec<_>>().join("\n")
        })
    }

    /// Arms an injection; a port that it distorts gets a tap first, or else the first data of its
    /// time would pass as they are.
    fn arm(&self, injection: Injection) -> Result<usize, String> {
        let port = match &injection.what {
            InjectedFault::Port {
                component, port, ..
            } => Some(self.port(*component, port)?),
            _ => None,
        };
        let tapped = injection.what.component().zip(port.map(|(index, _)| index));
        if let Some((component, port)) = tapped {
            self.supervisor.tap(component, port);
        }
        let environment = self.supervisor.environment();
        let data_type = port.and_then(|(index, port)| Some((index, port.data_type.as_ref()?)));
        let number = environment
            .injections
            .add(injection, environment.clock.now(), data_type)
            .map_err(|error| error.to_string())?;
        self.supervisor.rouse();
        Ok(number)
    }

    fn port(&self, component: usize, name: &str) -> Result<(usize, &PortDescription), String> {
        let ports = self.interfaces.get(component).into_iter().flatten();
        let found = ports.enumerate().find(|(_, port)| port.name == name);
        found
            .ok_or_else(|| format!("the library has no port '{name}'; see the component's profile"))
    }
}

/// A problem in a text of one line: what is wrong, and what to do.
fn words(problem: &Problem) -> String {
    let help = problem.help.as_ref();
    let help = help.map_or_else(String::new, |help| format!("\n  help: {help}"));
    format!("{}: {}{help}", problem.place, problem.message)
}
