//! Connections with the fault manager, which is there without being declared.

use system_model::profile::{ConnectionEnd, Located, PortConnection};
use system_model::specification::{
    FAULT_MANAGER, ManagerConnection, ManagerPort, PortDirection, PortKind, PortReference,
};

use super::instances::Scope;
use super::ports::Port;
use super::{Assembly, LoadedFile};
use crate::problem::Severity;
use crate::suggest::{self, quoted};

/// Whether the fault manager is at an end of a connection.
pub(super) fn is_end(connection: &PortConnection) -> bool {
    is_manager(&connection.source) || is_manager(&connection.target)
}

fn is_manager(end: &ConnectionEnd) -> bool {
    end.component.value == FAULT_MANAGER
}

/// Refuses the fault manager's name for a component.
pub(super) fn report_reserved(file: &LoadedFile, name: &Located<String>) {
    if name.value == FAULT_MANAGER {
        file.document.report(
            Severity::Error,
            name,
            format!("`{FAULT_MANAGER}` is the fault manager's own name"),
            Some("call the component otherwise; connections may name the fault manager".into()),
        );
    }
}

impl Assembly<'_> {
    /// Resolves a connection that has the fault manager at an end.
    pub(super) fn connect_manager(&mut self, scope: &Scope, connection: &PortConnection) {
        let (source, target) = (&connection.source, &connection.target);
        let (manager_end, end, direction) = match (is_manager(source), is_manager(target)) {
            (true, false) => (source, target, PortDirection::Output),
            (false, true) => (target, source, PortDirection::Input),
            _ => {
                error(
                    scope,
                    &target.component,
                    "the fault manager needs no telling",
                    "name a component of the application at one end",
                );
                return;
            }
        };
        let manager = manager_port(scope, manager_end, direction);
        let port = self.port(scope, end);
        let (Some(manager), Some(port)) = (manager, port) else {
            return;
        };
        if !fits(scope, connection, end, direction, &port) {
            return;
        }
        let place = connection.source.component.place.clone();
        let component = PortReference {
            component: port.component,
            port: port.name,
        };
        let mut others = self.manager_connections.iter();
        let first = others.find(|one| (one.manager, &one.component) == (manager, &component));
        if let Some(first) = first {
            let help = format!(
                "the first connection is at {}; remove one of them",
                first.place
            );
            error(
                scope,
                &target.port,
                "this connection was already made",
                &help,
            );
            return;
        }
        self.manager_connections.push(ManagerConnection {
            manager,
            component,
            place,
        });
    }
}

fn error(scope: &Scope, at: &Located<String>, message: &str, help: &str) {
    let document = &scope.file.document;
    document.report(Severity::Error, at, message, Some(help.to_owned()));
}

/// The fault manager's port of a name that faces this way; an error if there is none.
fn manager_port(
    scope: &Scope,
    end: &ConnectionEnd,
    direction: PortDirection,
) -> Option<ManagerPort> {
    let facing = || {
        let ports = ManagerPort::ALL.into_iter();
        ports.filter(|port| port.direction() == direction)
    };
    let found = facing().find(|port| port.name() == end.port.value);
    if found.is_none() && !end.port.value.is_empty() {
        let what = match direction {
            PortDirection::Output => "output",
            PortDirection::Input => "input",
        };
        scope.file.document.report(
            Severity::Error,
            &end.port,
            format!(
                "the fault manager has no {what} `{}`",
                quoted(&end.port.value)
            ),
            suggest::help(&end.port.value, "it has", facing().map(ManagerPort::name)),
        );
    }
    found
}

/// Whether a component's port can be connected with one of the fault manager that faces this way.
fn fits(
    scope: &Scope,
    connection: &PortConnection,
    end: &ConnectionEnd,
    direction: PortDirection,
    port: &Port,
) -> bool {
    let name = quoted(&port.name);
    if connection.kind.value != PortKind::Event {
        let message = format!(
            "a connection of kind {} with the fault manager",
            connection.kind.value.name()
        );
        error(
            scope,
            &end.port,
            &message,
            "its ports are event ports: write port_type=\"event\"",
        );
    } else if port.kind != PortKind::Event || port.direction == direction {
        let wanted = match direction {
            PortDirection::Output => "what the fault manager raises goes to an input event port",
            PortDirection::Input => "what the fault manager hears comes from an output event port",
        };
        let message = format!("the port {name} is {}", port.description());
        error(scope, &end.port, &message, wanted);
    } else if !port.data_type.is_empty() {
        let message = format!("the port {name} carries `{}`", quoted(&port.data_type));
        error(
            scope,
            &end.port,
            &message,
            "events of and for the fault manager have no content: connect a port without data_type",
        );
    } else {
        return true;
    }
    false
}
