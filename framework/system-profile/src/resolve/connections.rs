//! Connections: both ends exist, fit each other, and nobody is connected twice.

use std::collections::HashMap;
use std::rc::Rc;

use system_model::profile::{Located, PortConnection};
use system_model::specification::{
    ConnectionSpecification, PortDirection, PortKind, PortReference,
};

use super::instances::Scope;
use super::manager;
use super::ports::Port;
use super::{Assembly, LoadedFile};
use crate::problem::Severity;
use crate::suggest::quoted;

/// A connection whose ends fit each other, and where it was declared.
#[derive(Debug)]
pub(super) struct Wire {
    pub(super) connection: ConnectionSpecification,
    file: Rc<LoadedFile>,
    source_port: Located<String>,
    target_port: Located<String>,
}

impl Assembly<'_> {
    /// Resolves the connections of one file.
    pub(super) fn connect(&mut self, scope: &Scope, connections: &[PortConnection]) {
        for connection in connections {
            if scope.file.document.is_given_up() {
                return;
            }
            if manager::is_end(connection) {
                self.connect_manager(scope, connection);
                continue;
            }
            let source = self.port(scope, &connection.source);
            let target = self.port(scope, &connection.target);
            let (Some(source), Some(target)) = (source, target) else {
                continue;
            };
            if !fits(scope, connection, &source, &target) {
                continue;
            }
            self.wires.push(Wire {
                connection: ConnectionSpecification {
                    kind: connection.kind.value,
                    place: connection.source.component.place.clone(),
                    source: reference(source),
                    target: reference(target),
                },
                file: Rc::clone(&scope.file),
                source_port: connection.source.port.clone(),
                target_port: connection.target.port.clone(),
            });
        }
    }
}

fn reference(port: Port) -> PortReference {
    PortReference {
        component: port.component,
        port: port.name,
    }
}

/// Whether kind, directions and types agree; every disagreement is reported.
fn fits(scope: &Scope, connection: &PortConnection, source: &Port, target: &Port) -> bool {
    let document = &scope.file.document;
    let report = |at: &Located<String>, message: String, help: &str| {
        document.report(Severity::Error, at, message, Some(help.to_owned()));
        false
    };
    let ends = [
        (&connection.source.port, source, PortDirection::Output),
        (&connection.target.port, target, PortDirection::Input),
    ];
    let kind = connection.kind.value;
    let mut fits = true;
    for (at, port, direction) in ends {
        let what = || format!("the port {} is {}", quoted(&port.name), port.description());
        if port.kind != kind {
            let message = format!("{}, the connection one of kind {}", what(), kind.name());
            fits = report(at, message, "port_type and both ports are of one kind");
        } else if port.direction != direction {
            let help = match (kind, direction) {
                (PortKind::Service, _) => {
                    "calls go from a required port, the source, to a provided one, the target"
                }
                _ => "values go from an output, the source, to an input, the target",
            };
            fits = report(at, what(), help);
        }
    }
    let (given, taken) = (condensed(&source.data_type), condensed(&target.data_type));
    if fits && !given.is_empty() && !taken.is_empty() && given != taken {
        let message = format!(
            "the types differ: the source has {}, the target {}",
            quoted(&source.data_type),
            quoted(&target.data_type)
        );
        fits = report(
            &connection.target.port,
            message,
            "both ports are of one type",
        );
    }
    fits
}

/// C++ type names are written with and without blanks.
fn condensed(data_type: &str) -> String {
    data_type.split_whitespace().collect()
}

/// Checks what can only be seen with all connections at hand, those of composites too.
pub(super) fn check(wires: &[Wire]) {
    let mut pairs = HashMap::new();
    let mut writers = HashMap::new();
    let mut providers = HashMap::new();
    for wire in wires {
        let ConnectionSpecification {
            kind,
            source,
            target,
            ..
        } = &wire.connection;
        if let Some(first) = pairs.insert((source, target), wire) {
            wire.report(&wire.target_port, "this connection was already made", first);
            continue;
        }
        let taken = match kind {
            PortKind::Data => writers.insert(target, wire),
            PortKind::Event => None,
            PortKind::Service => providers.insert(source, wire),
        };
        match (taken, kind) {
            (Some(first), PortKind::Data) => {
                wire.report(
                    &wire.target_port,
                    "a second writer into one data input",
                    first,
                );
            }
            (Some(first), _) => {
                wire.report(
                    &wire.source_port,
                    "a second provider for one required service",
                    first,
                );
            }
            (None, _) => {}
        }
    }
}

impl Wire {
    fn report(&self, at: &Located<String>, message: &str, first: &Wire) {
        let first = &first.connection.place;
        self.file.document.report(
            Severity::Error,
            at,
            message,
            Some(format!(
                "the first connection is at {first}; remove one of them"
            )),
        );
    }
}
