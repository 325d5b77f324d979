//! Names of components, ports, executors and applications, and what is said about unknown ones.

use std::collections::HashMap;

use system_model::profile::Located;
use system_model::rules::{Entity, Provider, RulePort};
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, PortDirection, PortKind, PortSpecification,
};

use super::applications::Applications;
use super::executions::executor_of;
use crate::problem::Severity;
use crate::readers::rules::{DeclaredEnd, DeclaredName, EntityKind};
use crate::resolve::Assembly;
use crate::suggest::{self, quoted};

/// Everything that a rule can name.
#[derive(Debug)]
pub(super) struct Names<'a> {
    pub(super) application: &'a ApplicationSpecification,
    indices: HashMap<&'a str, usize>,
    applications: Applications,
}

impl<'a> Names<'a> {
    pub(super) fn new(
        application: &'a ApplicationSpecification,
        applications: Applications,
    ) -> Self {
        let components = application.components.iter().enumerate();
        Self {
            application,
            indices: components
                .map(|(index, component)| (component.name.as_str(), index))
                .collect(),
            applications,
        }
    }

    fn components(&self) -> impl Iterator<Item = &'a str> {
        self.application
            .components
            .iter()
            .map(|component| component.name.as_str())
    }

    /// The component of an index.
    pub(super) fn specification(&self, index: usize) -> &'a ComponentSpecification {
        &self.application.components[index]
    }

    /// The component of a name; an error if there is none.
    pub(super) fn component(
        &self,
        assembly: &Assembly<'_>,
        name: &Located<String>,
    ) -> Option<usize> {
        let found = self.indices.get(name.value.as_str()).copied();
        if found.is_none() {
            self.report(assembly, "component", name, self.components());
        }
        found
    }

    /// The executor of a name, by its first component; an error if there is none.
    pub(super) fn executor(
        &self,
        assembly: &Assembly<'_>,
        name: &Located<String>,
    ) -> Option<usize> {
        let components = &self.application.components;
        let is_first = |index: &usize| executor_of(components, *index) == *index;
        let found = self.indices.get(name.value.as_str()).copied();
        let found = found.filter(is_first);
        if found.is_none() {
            let names = (0..components.len()).filter(is_first);
            let names = names.map(|index| components[index].name.as_str());
            self.report(assembly, "executor", name, names);
        }
        found
    }

    /// Whether any component belongs to a node; an error if none does.
    pub(super) fn node(&self, assembly: &Assembly<'_>, name: &Located<String>) -> bool {
        let nodes = self
            .application
            .components
            .iter()
            .map(|component| component.node.as_str());
        let found = nodes.clone().any(|node| node == name.value);
        if !found {
            self.report(
                assembly,
                "node",
                name,
                nodes.filter(|node| !node.is_empty()),
            );
        }
        found
    }

    /// Whether there is an application of a name; an error if there is none.
    pub(super) fn application(&self, assembly: &Assembly<'_>, name: &Located<String>) -> bool {
        let found = self.applications.contain(&name.value);
        if !found {
            self.report(assembly, "application", name, self.applications.names());
        }
        found
    }

    /// What a name of a dependency means: a component, or else an application.
    pub(super) fn entity(&self, assembly: &Assembly<'_>, name: &DeclaredName) -> Option<Provider> {
        let text = &name.name.value;
        let entity = match name.kind {
            Some(EntityKind::Component) => Entity::Component(self.component(assembly, &name.name)?),
            Some(EntityKind::Executor) => Entity::Executor(self.executor(assembly, &name.name)?),
            Some(EntityKind::Application) => {
                if !self.application(assembly, &name.name) {
                    return None;
                }
                Entity::Application(text.clone())
            }
            None => match self.indices.get(text.as_str()) {
                Some(index) => Entity::Component(*index),
                None if self.applications.contain(text) => Entity::Application(text.clone()),
                None => {
                    let all = self.components().chain(self.applications.names());
                    self.report(assembly, "component or application", &name.name, all);
                    return None;
                }
            },
        };
        Some(Provider {
            entity,
            name: text.clone(),
        })
    }

    /// The port of a component; an error if there is none.
    pub(super) fn port(
        &self,
        assembly: &Assembly<'_>,
        component: usize,
        name: &Located<String>,
    ) -> Option<&'a PortSpecification> {
        let component = self.specification(component);
        let found = component.ports.iter().find(|port| port.name == name.value);
        if found.is_none() {
            let names = component.ports.iter().map(|port| port.name.as_str());
            let help = suggest::help(&name.value, "it has", names);
            assembly.report_at(
                Severity::Error,
                &name.place,
                format!(
                    "`{}` has no port `{}`",
                    quoted(&component.name),
                    quoted(&name.value)
                ),
                help.unwrap_or_else(|| "it has no ports at all".into()),
            );
        }
        found
    }

    /// The data port that a monitor or voter names; an error if there is none, or if it faces the
    /// wrong way.
    pub(super) fn data_port(
        &self,
        assembly: &Assembly<'_>,
        end: &DeclaredEnd,
        direction: Option<PortDirection>,
    ) -> Option<RulePort> {
        let component = self.component(assembly, &end.component)?;
        let port = self.port(assembly, component, &end.port)?;
        let fits = port.kind == PortKind::Data
            && direction.is_none_or(|direction| port.direction == direction);
        if !fits {
            let wanted = match direction {
                Some(PortDirection::Input) => "an input data port",
                Some(PortDirection::Output) => "an output data port",
                None => "a data port",
            };
            assembly.report_at(
                Severity::Error,
                &end.port.place,
                format!(
                    "the port {} is {}, not {wanted}",
                    quoted(&port.name),
                    description(port)
                ),
                format!("name {wanted}"),
            );
            return None;
        }
        Some(RulePort {
            component,
            port: port.name.clone(),
            field: end.field.clone(),
            data_type: port.data_type.clone(),
        })
    }

    fn report<'n>(
        &self,
        assembly: &Assembly<'_>,
        kind: &str,
        name: &Located<String>,
        known: impl Iterator<Item = &'n str>,
    ) {
        if name.value.is_empty() {
            return;
        }
        let help = suggest::help(&name.value, "there are", known);
        assembly.report_at(
            Severity::Error,
            &name.place,
            format!("there is no {kind} `{}`", quoted(&name.value)),
            help.unwrap_or_else(|| format!("the application has no {kind} at all")),
        );
    }
}

/// Kind and direction of a port in the words of profiles.
pub(super) fn description(port: &PortSpecification) -> &'static str {
    crate::resolve::ports::description(port.kind, port.direction)
}
