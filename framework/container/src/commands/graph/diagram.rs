//! An application as nodes and edges, whatever they are drawn with.

mod notes;
mod rules;

use fault_manager::Scope;
use serde::Serialize;
use system_model::specification::{
    ComponentSpecification, ExecutionKind, PortDirection, PortKind, PortReference,
};

/// Nodes, edges, and which nodes are run together.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Diagram {
    /// Names of the applications.
    pub title: String,
    /// Components, monitors, voters.
    pub nodes: Vec<Node>,
    /// What goes from one to another.
    pub edges: Vec<Edge>,
    /// Executors.
    pub executors: Vec<Executor>,
}

/// One box.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Node {
    /// Name, unique in the diagram.
    pub name: String,
    /// What it is.
    pub kind: NodeKind,
    /// What is to be known of it, a line each.
    pub notes: Vec<String>,
    /// Names of ports that something goes in by.
    pub inputs: Vec<String>,
    /// Names of ports that something goes out by.
    pub outputs: Vec<String>,
}

/// What a node is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NodeKind {
    /// A component.
    Component,
    /// A component that moves something.
    Actuator,
    /// A process model.
    ProcessModel,
    /// A voter.
    Voter,
    /// The fault manager.
    FaultManager,
}

/// What goes from one node to another.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Edge {
    /// What goes.
    pub kind: EdgeKind,
    /// From where.
    pub source: End,
    /// To where.
    pub target: End,
}

/// What goes along an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EdgeKind {
    /// Data.
    Data,
    /// Events.
    Event,
    /// Calls.
    Service,
    /// A process model looks on.
    Watch,
    /// The source needs the target.
    Dependency,
}

/// One end of an edge.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct End {
    /// Index of the node.
    pub node: usize,
    /// The port; none for the node as a whole.
    pub port: Option<String>,
}

/// Components that are run by one thread.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Executor {
    /// How it runs.
    pub label: String,
    /// Indices of nodes.
    pub members: Vec<usize>,
}

impl Diagram {
    /// Of all applications of a container.
    pub fn new(scopes: &[Scope]) -> Self {
        let names = scopes.iter().map(|scope| scope.specification.name.as_str());
        let mut diagram = Self {
            title: names.collect::<Vec<_>>().join(", "),
            ..Self::default()
        };
        for scope in scopes {
            diagram.add(scope, scopes.len() > 1);
        }
        diagram
    }

    fn add(&mut self, scope: &Scope, prefixed: bool) {
        let first = self.nodes.len();
        let components = &scope.specification.components;
        for (index, component) in components.iter().enumerate() {
            self.nodes.push(node(scope, index, prefixed));
            self.run_by(component, components, first, index);
        }
        for connection in &scope.specification.connections {
            let kind = match connection.kind {
                PortKind::Data => EdgeKind::Data,
                PortKind::Event => EdgeKind::Event,
                PortKind::Service => EdgeKind::Service,
            };
            let end = |end: &PortReference| End {
                node: first + end.component,
                port: Some(end.port.clone()),
            };
            self.edges.push(Edge {
                kind,
                source: end(&connection.source),
                target: end(&connection.target),
            });
        }
        self.add_monitors(scope, first);
        self.add_votings(scope, first);
        self.add_manager(scope, first);
        self.add_dependencies(scope, first);
    }

    /// Puts a component into its executor.
    fn run_by(
        &mut self,
        component: &ComponentSpecification,
        components: &[ComponentSpecification],
        first: usize,
        index: usize,
    ) {
        let execution = &component.execution;
        let with = |member: &usize| {
            let other = member.checked_sub(first).and_then(|it| components.get(it));
            other.is_some_and(|other| match execution.kind {
                ExecutionKind::Passive => other.execution.kind == ExecutionKind::Passive,
                ExecutionKind::PeriodicShared => other.execution == *execution,
                ExecutionKind::Periodic | ExecutionKind::Aperiodic => false,
            })
        };
        let mut executors = self.executors.iter_mut();
        match executors.find(|executor| executor.members.iter().any(with)) {
            Some(executor) => executor.members.push(first + index),
            None => self.executors.push(Executor {
                label: notes::rhythm(execution),
                members: vec![first + index],
            }),
        }
    }
}

fn node(scope: &Scope, index: usize, prefixed: bool) -> Node {
    let component = &scope.specification.components[index];
    let facing = |direction: PortDirection| {
        let ports = component.ports.iter();
        let ports = ports.filter(|port| port.direction == direction);
        ports.map(|port| port.name.clone()).collect()
    };
    let actuator = scope.rules.components[index].actuator.is_some();
    Node {
        name: match prefixed {
            true => format!("{}/{}", scope.specification.name, component.name),
            false => component.name.clone(),
        },
        kind: match actuator {
            true => NodeKind::Actuator,
            false => NodeKind::Component,
        },
        notes: notes::component(scope, index),
        inputs: facing(PortDirection::Input),
        outputs: facing(PortDirection::Output),
    }
}
