//! Ports by the names that connections and exports give them.

use system_model::profile::{CompositeProfile, ConnectionEnd, Located};
use system_model::specification::{PortDirection, PortKind};

use super::Assembly;
use super::instances::{Member, Scope};
use crate::problem::Severity;
use crate::suggest::{self, quoted};

/// A port of a component, however it was named.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Port {
    pub(super) component: usize,
    pub(super) name: String,
    pub(super) kind: PortKind,
    pub(super) direction: PortDirection,
    pub(super) data_type: String,
}

impl Assembly<'_> {
    /// The ports of a composite; without a target where an export is wrong.
    pub(super) fn exports(
        &self,
        scope: &Scope,
        profile: &CompositeProfile,
    ) -> Vec<(String, Option<Port>)> {
        let mut exports: Vec<(String, Option<Port>)> = Vec::new();
        for export in &profile.exports {
            let port = self.port(scope, &export.member);
            let agrees = |port: &Port| {
                port.kind == export.kind.value && port.direction == export.direction.value
            };
            if let Some(port) = port.as_ref().filter(|port| !agrees(port)) {
                report_wrong_export(scope, &export.member.port, port);
            }
            let port = port.filter(agrees);
            if exports.iter().any(|(name, _)| *name == export.name.value) {
                scope.file.document.report(
                    Severity::Error,
                    &export.name,
                    format!(
                        "a second exported port of the name {}",
                        quoted(&export.name.value)
                    ),
                    Some("give each a name of its own: <export_port_name>".into()),
                );
            }
            exports.push((export.name.value.clone(), port));
        }
        exports
    }

    /// The port that a connection or an export names; an error if there is none.
    pub(super) fn port(&self, scope: &Scope, end: &ConnectionEnd) -> Option<Port> {
        let names: Vec<&str> = match scope.member(&end.component)? {
            Member::Unknown => return None,
            Member::Composite(composite) => {
                let mut exports = composite.exports.iter();
                if let Some((_, port)) = exports.find(|(name, _)| *name == end.port.value) {
                    return port.clone();
                }
                composite
                    .exports
                    .iter()
                    .map(|(name, _)| &name[..])
                    .collect()
            }
            Member::Component(index) => {
                let ports = &self.components[*index].ports;
                if let Some(port) = ports.iter().find(|port| port.name == end.port.value) {
                    return Some(Port {
                        component: *index,
                        name: port.name.clone(),
                        kind: port.kind,
                        direction: port.direction,
                        data_type: port.data_type.clone(),
                    });
                }
                ports.iter().map(|port| &port.name[..]).collect()
            }
        };
        if !end.port.value.is_empty() {
            scope.file.document.report(
                Severity::Error,
                &end.port,
                format!(
                    "`{}` has no port `{}`",
                    quoted(&end.component.value),
                    quoted(&end.port.value)
                ),
                suggest::help(&end.port.value, "it has", names)
                    .or_else(|| Some("it has no ports at all".into())),
            );
        }
        None
    }
}

fn report_wrong_export(scope: &Scope, at: &Located<String>, port: &Port) {
    scope.file.document.report(
        Severity::Error,
        at,
        format!("the port {} is {}", quoted(&port.name), port.description()),
        Some("port_type and port_dir of an exported port are those of the member's port".into()),
    );
}

impl Port {
    /// Kind and direction in the words of profiles.
    pub(super) fn description(&self) -> &'static str {
        description(self.kind, self.direction)
    }
}

/// Kind and direction of a port in the words of profiles.
pub(super) fn description(kind: PortKind, direction: PortDirection) -> &'static str {
    match (kind, direction) {
        (PortKind::Data, PortDirection::Input) => "an input data port",
        (PortKind::Data, PortDirection::Output) => "an output data port",
        (PortKind::Event, PortDirection::Input) => "an input event port",
        (PortKind::Event, PortDirection::Output) => "an output event port",
        (PortKind::Service, PortDirection::Input) => "a provided service port",
        (PortKind::Service, PortDirection::Output) => "a required service port",
    }
}
