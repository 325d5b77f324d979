//! Nodes and edges of what only rules say: monitors, voters, the fault manager's ports, dependencies.

use fault_manager::Scope;
use system_model::rules::{Entity, Provider, RulePort};
use system_model::specification::{FAULT_MANAGER, PortDirection};

use super::{Diagram, Edge, EdgeKind, End, Node, NodeKind, notes};

impl Diagram {
    fn push(&mut self, name: &str, kind: NodeKind, notes: Vec<String>) -> usize {
        let mut unique = name.to_owned();
        while self.nodes.iter().any(|node| node.name == unique) {
            unique.push('\'');
        }
        self.nodes.push(Node {
            name: unique,
            kind,
            notes,
            inputs: Vec::new(),
            outputs: Vec::new(),
        });
        self.nodes.len() - 1
    }

    pub(super) fn add_monitors(&mut self, scope: &Scope, first: usize) {
        for monitor in &scope.rules.monitors {
            let notes = notes::process_model(&monitor.rule.value);
            let node = self.push(&monitor.name, NodeKind::ProcessModel, notes);
            let mut seen: Vec<End> = Vec::new();
            for port in monitor.inputs.iter().chain(&monitor.outputs) {
                let source = rule_end(first, port);
                if !seen.contains(&source) {
                    seen.push(source.clone());
                    let target = End { node, port: None };
                    let kind = EdgeKind::Watch;
                    self.edges.push(Edge {
                        kind,
                        source,
                        target,
                    });
                }
            }
        }
    }

    pub(super) fn add_votings(&mut self, scope: &Scope, first: usize) {
        for voting in &scope.rules.votings {
            let notes = notes::voter(&voting.rule.value);
            let node = self.push(&voting.name, NodeKind::Voter, notes);
            let voter = End { node, port: None };
            let sources = voting.sources.iter().map(|source| Edge {
                kind: EdgeKind::Data,
                source: rule_end(first, &source.port),
                target: voter.clone(),
            });
            self.edges.extend(sources);
            self.edges.push(Edge {
                kind: EdgeKind::Data,
                source: voter,
                target: rule_end(first, &voting.output),
            });
        }
    }

    pub(super) fn add_manager(&mut self, scope: &Scope, first: usize) {
        let connections = &scope.specification.manager_connections;
        if connections.is_empty() {
            return;
        }
        let manager = self.push(FAULT_MANAGER, NodeKind::FaultManager, Vec::new());
        for connection in connections {
            let port = connection.manager.name().to_owned();
            let own = &mut self.nodes[manager];
            let is_output = connection.manager.direction() == PortDirection::Output;
            let ports = match is_output {
                true => &mut own.outputs,
                false => &mut own.inputs,
            };
            if !ports.contains(&port) {
                ports.push(port.clone());
            }
            let manager = End {
                node: manager,
                port: Some(port),
            };
            let component = End {
                node: first + connection.component.component,
                port: Some(connection.component.port.clone()),
            };
            let (source, target) = match is_output {
                true => (manager, component),
                false => (component, manager),
            };
            self.edges.push(Edge {
                kind: EdgeKind::Event,
                source,
                target,
            });
        }
    }

    /// Dependencies between components; those of executors and applications are among the notes.
    pub(super) fn add_dependencies(&mut self, scope: &Scope, first: usize) {
        let whole = |provider: &Provider| match provider.entity {
            Entity::Component(index) | Entity::Executor(index) => Some(End {
                node: first + index,
                port: None,
            }),
            Entity::Application(_) => None,
        };
        for rule in &scope.rules.dependencies {
            let Some(source) = whole(&rule.value.dependent) else {
                continue;
            };
            for target in rule.value.providers.iter().filter_map(whole) {
                self.edges.push(Edge {
                    kind: EdgeKind::Dependency,
                    source: source.clone(),
                    target,
                });
            }
        }
    }
}

fn rule_end(first: usize, port: &RulePort) -> End {
    End {
        node: first + port.component,
        port: Some(port.port.clone()),
    }
}
