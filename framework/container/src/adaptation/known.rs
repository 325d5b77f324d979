//! What a task may refer to: the components and ports of the application that it is attached to.

use std::ops::Range;

use fault_manager::detection::NumberReader;
use system_model::data_type::DataType;
use system_model::specification::{
    ApplicationSpecification, Place, PortDirection, PortKind, QueuePolicy,
};

use super::wiring::PortKey;
use crate::assembly::AssemblyProblem;
use crate::library::PortDescription;

/// What a task may refer to.
pub struct Known<'start> {
    /// All applications as one.
    pub specification: &'start ApplicationSpecification,
    /// The components of the application that the task is attached to.
    pub members: Range<usize>,
    /// The types of all data ports, by component and port.
    pub interfaces: &'start [Vec<PortDescription>],
}

impl Known<'_> {
    /// A component by its name in the application.
    pub(super) fn component(
        &self,
        name: &str,
        place: &Place,
        problems: &mut Vec<AssemblyProblem>,
    ) -> Option<usize> {
        // With several applications in one container names begin with that of the application.
        let mut members = self.members.clone();
        let found = members.find(|index| {
            let full = self.specification.components[*index].name.as_str();
            full == name || full.strip_suffix(name).is_some_and(|it| it.ends_with('/'))
        });
        if found.is_none() {
            let members = self.members.clone();
            let names = members.map(|it| self.specification.components[it].name.as_str());
            problems.push(misfit(
                place,
                format!("the application has no component '{name}'"),
                &format!(
                    "write subcomponent=\"…\"; there are {}",
                    names.collect::<Vec<_>>().join(", ")
                ),
            ));
        }
        found
    }

    /// The data ports of a component that face one way.
    pub(super) fn data_ports(
        &self,
        component: usize,
        direction: PortDirection,
    ) -> impl Iterator<Item = &PortDescription> {
        let ports = self.interfaces[component].iter();
        ports.filter(move |port| port.kind == PortKind::Data && port.direction == direction)
    }

    /// An output with its type.
    pub(super) fn output(
        &self,
        component: usize,
        name: &str,
        place: &Place,
        problems: &mut Vec<AssemblyProblem>,
    ) -> Option<(PortKey, &DataType)> {
        let mut ports = self.data_ports(component, PortDirection::Output);
        let found = ports.find(|port| port.name == name);
        let found = found.and_then(|port| port.data_type.as_ref());
        if found.is_none() {
            let ports = self.data_ports(component, PortDirection::Output);
            let names: Vec<&str> = ports.map(|port| port.name.as_str()).collect();
            problems.push(misfit(
                place,
                format!(
                    "'{}' has no output '{name}'",
                    self.specification.components[component].name
                ),
                &format!("it has {}", names.join(", ")),
            ));
        }
        let port = name.to_owned();
        Some((PortKey { component, port }, found?))
    }

    /// A number that an output carries.
    pub(super) fn number(
        &self,
        component: usize,
        port: &str,
        field: Option<&str>,
        place: &Place,
        problems: &mut Vec<AssemblyProblem>,
    ) -> Option<(PortKey, NumberReader)> {
        let (key, data_type) = self.output(component, port, place, problems)?;
        match NumberReader::compile(data_type, field, 0) {
            Ok(reader) => Some((key, reader)),
            Err(error) => {
                let help = "write field=\"…\" with one of them";
                problems.push(misfit(place, format!("port '{port}': {error}"), help));
                None
            }
        }
    }

    /// The one port of a component that faces this way and carries this type.
    pub(super) fn only_port(
        &self,
        component: usize,
        direction: PortDirection,
        name: Option<&str>,
        data_type: &DataType,
        place: &Place,
    ) -> Result<PortKey, AssemblyProblem> {
        let fits = |port: &&PortDescription| {
            let own = port.data_type.as_ref();
            own.is_some_and(|own| own.fits(data_type)) && name.is_none_or(|name| name == port.name)
        };
        let ports: Vec<_> = self.data_ports(component, direction).filter(fits).collect();
        if let [port] = ports[..] {
            let port = port.name.clone();
            return Ok(PortKey { component, port });
        }
        let what = match direction {
            PortDirection::Input => "inputs",
            PortDirection::Output => "outputs",
        };
        Err(misfit(
            place,
            format!(
                "'{}' has {} {what} that are meant, of the type {} that this link carries",
                self.specification.components[component].name,
                ports.len(),
                data_type.name
            ),
            "write input=\"…\" and output=\"…\" in its <through>",
        ))
    }

    /// What an input keeps, as its profile says.
    pub(super) fn queue(&self, input: &PortKey) -> (QueuePolicy, usize) {
        let ports = &self.specification.components[input.component].ports;
        let declared = ports.iter().find(|port| port.name == input.port);
        declared.map_or((QueuePolicy::Last, 1), |port| (port.queue, port.queue_size))
    }
}

/// Something of the task that the application does not have.
pub(super) fn misfit(place: &Place, message: String, help: &str) -> AssemblyProblem {
    AssemblyProblem::Connection {
        place: place.clone(),
        message,
        help: help.to_owned(),
    }
}
