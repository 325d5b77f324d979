//! All data ports of all components, and how they are connected.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use system_model::specification::{
    PortDirection, PortKind, PortReference, PortSpecification, QueuePolicy,
};

use super::votes::Vote;
use super::watch::Watch;
use super::{Datum, Port};
use crate::manager::FaultManager;
use crate::system::Scope;
use crate::what_if::Assumptions;

/// All data ports of all components.
#[derive(Debug)]
pub(in crate::what_if::stand_in) struct Wiring {
    outputs: BTreeMap<Port, Output>,
    inputs: BTreeMap<Port, Input>,
    pub(super) votes: Vec<Vote>,
}

/// An output.
#[derive(Debug, Default)]
pub(super) struct Output {
    pub targets: Vec<Port>,
    pub watch: Watch,
    pub delayed: VecDeque<(Duration, Datum)>,
}

/// An input.
#[derive(Debug, Default)]
pub(super) struct Input {
    pub waiting: VecDeque<Datum>,
    room: usize,
    pub watch: Watch,
    pub delayed: VecDeque<(Duration, Datum)>,
    /// When the newest datum was written that was sent to it.
    newest: Option<Duration>,
    /// When the last datum came to the component.
    pub delivered: Option<Duration>,
    /// That datum.
    pub last: Datum,
    /// The longest time from one to the next while all was well.
    pub usual: Duration,
    /// The component passes on what comes here.
    passes_on: bool,
}

impl Input {
    /// A datum was sent to it.
    pub fn receive(&mut self, datum: Datum) {
        if self.waiting.len() >= self.room.max(1) {
            self.waiting.pop_front();
        }
        self.waiting.push_back(datum);
        self.newest = self.newest.max(Some(datum.stamp));
    }

    /// Whether data do not come any more as they used to.
    pub fn is_silent(&self, now: Duration) -> bool {
        let age = self.delivered.map(|at| now.saturating_sub(at));
        age.is_some_and(|age| age > self.usual)
    }
}

impl Wiring {
    /// As applications and rules have it; `firsts` are the numbers of the first component of each.
    pub fn new(
        scopes: &[Scope],
        firsts: &[usize],
        manager: &FaultManager,
        assumptions: &Assumptions,
    ) -> Self {
        let mut wiring = Self {
            outputs: BTreeMap::new(),
            inputs: BTreeMap::new(),
            votes: Vec::new(),
        };
        for (scope, first) in scopes.iter().zip(firsts) {
            for (index, component) in scope.specification.components.iter().enumerate() {
                let ports = component.ports.iter();
                for port in ports.filter(|port| port.kind == PortKind::Data) {
                    wiring.add(first + index, port, manager);
                }
            }
            wiring.connect(scope, *first);
            for (voting, rule) in scope.rules.votings.iter().enumerate() {
                let vote = Vote::new(voting, rule, *first, manager);
                // It stands in for what is connected.
                for output in wiring.outputs.values_mut() {
                    output.targets.retain(|target| *target != vote.output);
                }
                wiring.votes.push(vote);
            }
        }
        for end in &assumptions.passes_on {
            let port = (firsts[end.application] + end.component, end.port.clone());
            if let Some(input) = wiring.inputs.get_mut(&port) {
                input.passes_on = true;
            }
        }
        wiring
    }

    /// When the newest datum of an input was written.
    pub fn newest(&self, component: usize, port: &str) -> Option<Duration> {
        self.inputs.get(&(component, port.to_owned()))?.newest
    }

    /// When the last datum came to the component at an input.
    pub fn delivered(&self, port: &Port) -> Option<Duration> {
        self.inputs.get(port)?.delivered
    }

    pub(super) fn input(&mut self, port: &Port) -> Option<&mut Input> {
        self.inputs.get_mut(port)
    }

    pub(super) fn output(&mut self, port: &Port) -> Option<&mut Output> {
        self.outputs.get_mut(port)
    }

    pub(super) fn inputs_of(&self, component: usize) -> Vec<Port> {
        let own = self.inputs.keys().filter(|port| port.0 == component);
        own.cloned().collect()
    }

    pub(super) fn outputs_of(&self, component: usize) -> Vec<Port> {
        let own = self.outputs.keys().filter(|port| port.0 == component);
        own.cloned().collect()
    }

    /// Inputs of a component of which it passes on what comes there.
    pub(super) fn passing_inputs(
        &self,
        component: usize,
    ) -> impl Iterator<Item = &Input> + Clone + '_ {
        let own = self.inputs.iter();
        own.filter(move |(port, input)| port.0 == component && input.passes_on)
            .map(|(_, input)| input)
    }

    fn add(&mut self, component: usize, port: &PortSpecification, manager: &FaultManager) {
        let key = (component, port.name.clone());
        let watch = Watch::new(manager, component, &port.name);
        if port.direction == PortDirection::Output {
            let output = Output {
                watch,
                ..Output::default()
            };
            self.outputs.insert(key, output);
            return;
        }
        let input = Input {
            watch,
            room: match port.queue {
                QueuePolicy::Last => 1,
                QueuePolicy::Fifo | QueuePolicy::Lifo => port.queue_size,
            },
            ..Input::default()
        };
        self.inputs.insert(key, input);
    }

    fn connect(&mut self, scope: &Scope, first: usize) {
        let end = |end: &PortReference| (first + end.component, end.port.clone());
        let connections = scope.specification.connections.iter();
        for connection in connections.filter(|it| it.kind == PortKind::Data) {
            if let Some(output) = self.outputs.get_mut(&end(&connection.source)) {
                output.targets.push(end(&connection.target));
            }
        }
    }
}
