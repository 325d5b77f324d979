//! Instances: each reference opened, composites flattened into their members.

use std::ops::Range;
use std::rc::Rc;

use system_model::profile::{
    ComponentProfile, CompositeProfile, Located, Profile, Property, Subcomponent,
};
use system_model::specification::ComponentSpecification;

use super::manager;
use super::ports::Port;
use super::rules::Site;
use super::{Assembly, LoadedFile, Sibling};
use crate::problem::Severity;
use crate::suggest::{self, quoted};

/// Composites inside each other; a deeper nest is a mistake of a tool.
const MAX_COMPOSITE_DEPTH: usize = 16;

/// Instances of one application, composites counted: each takes a stack and maybe a thread, and a
/// few small files can name each other into millions.
const MAX_INSTANCES: usize = 1024;

/// The instances that one file can name in its connections.
#[derive(Debug)]
pub(super) struct Scope {
    pub(super) file: Rc<LoadedFile>,
    members: Vec<(Located<String>, Member)>,
}

/// One instance.
#[derive(Debug)]
pub(super) enum Member {
    /// Its index among the components.
    Component(usize),
    /// A composite.
    Composite(Composite),
    /// Its profile could not be used; a problem says why.
    Unknown,
}

/// A composite, seen from outside.
#[derive(Debug, Default)]
pub(super) struct Composite {
    /// Its components, those of inner composites too.
    pub(super) components: Range<usize>,
    /// Its ports; without a target where the export itself is wrong.
    pub(super) exports: Vec<(String, Option<Port>)>,
}

impl Scope {
    /// The member of a name; an error with the nearest name if there is none.
    pub(super) fn member(&self, name: &Located<String>) -> Option<&Member> {
        let found = self
            .members
            .iter()
            .find(|(other, _)| other.value == name.value);
        if found.is_none() && !name.value.is_empty() {
            let names = self.members.iter().map(|(name, _)| name.value.as_str());
            self.file.document.report(
                Severity::Error,
                name,
                format!("there is no subcomponent `{}`", quoted(&name.value)),
                suggest::help(&name.value, "there are", names),
            );
        }
        found.map(|(_, member)| member)
    }
}

impl Assembly<'_> {
    /// Instantiates the subcomponents of a file; their names get `prefix`, and those without a
    /// node belong to `node`.
    pub(super) fn members(
        &mut self,
        file: &Rc<LoadedFile>,
        subcomponents: &[Subcomponent],
        prefix: &str,
        node: &str,
    ) -> Scope {
        let mut scope = Scope {
            file: Rc::clone(file),
            members: Vec::new(),
        };
        for subcomponent in subcomponents {
            report_duplicate(&scope, &subcomponent.name);
            manager::report_reserved(file, &subcomponent.name);
            self.instances += 1;
            if self.instances > MAX_INSTANCES {
                file.document.report(
                    Severity::Error,
                    &subcomponent.name,
                    format!("the application has more than {MAX_INSTANCES} instances"),
                    Some("split it into several applications".into()),
                );
                break;
            }
            let member = self.member(file, subcomponent, prefix, node);
            let member = member.unwrap_or(Member::Unknown);
            scope.members.push((subcomponent.name.clone(), member));
        }
        scope
    }

    fn member(
        &mut self,
        file: &Rc<LoadedFile>,
        subcomponent: &Subcomponent,
        prefix: &str,
        node: &str,
    ) -> Option<Member> {
        let path = self.find(file, &subcomponent.reference, Sibling::Components)?;
        let referenced = self.files.open(&path);
        let name = format!("{prefix}{}", subcomponent.name.value);
        let node = match subcomponent.node.as_str() {
            "" => node,
            own => own,
        };
        match referenced.profile.as_ref()? {
            Profile::Component(profile) => {
                self.components
                    .push(component(profile, subcomponent, name, node));
                self.sites.push(Site {
                    profile: Rc::clone(&referenced),
                    holder: Rc::clone(file),
                    subcomponent: subcomponent.clone(),
                    prefix: prefix.to_owned(),
                });
                report_missing_library(&referenced, profile);
                Some(Member::Component(self.components.len() - 1))
            }
            Profile::Composite(profile) => {
                report_unread_properties(file, subcomponent);
                self.enter(file, &subcomponent.reference, &referenced)?;
                let composite = self.expand(&referenced, profile, &format!("{name}/"), node);
                self.open_composites.pop();
                Some(Member::Composite(composite))
            }
            _ => {
                let root = referenced.document.root_name().unwrap_or_default();
                file.document.report(
                    Severity::Error,
                    &subcomponent.reference,
                    format!("<{root}> cannot be a subcomponent"),
                    Some("refer to a component_profile or a composite_component_profile".into()),
                );
                None
            }
        }
    }

    /// Notes that a composite is being expanded, unless it is inside itself or too deep.
    fn enter(
        &mut self,
        file: &Rc<LoadedFile>,
        reference: &Located<String>,
        composite: &LoadedFile,
    ) -> Option<()> {
        let identity = &composite.identity;
        let message = if self.open_composites.contains(identity) {
            "the composite contains itself".to_owned()
        } else if self.open_composites.len() >= MAX_COMPOSITE_DEPTH {
            format!("more than {MAX_COMPOSITE_DEPTH} composites in each other")
        } else {
            self.open_composites.push(identity.clone());
            return Some(());
        };
        let help = "a composite is made of components and of other, smaller composites";
        let document = &file.document;
        document.report(Severity::Error, reference, message, Some(help.into()));
        None
    }

    /// Instantiates and connects the members of a composite and resolves its ports.
    pub(super) fn expand(
        &mut self,
        file: &Rc<LoadedFile>,
        profile: &CompositeProfile,
        prefix: &str,
        node: &str,
    ) -> Composite {
        let first = self.components.len();
        self.expanded.push((Rc::clone(file), prefix.to_owned()));
        let scope = self.members(file, &profile.subcomponents, prefix, node);
        self.connect(&scope, &profile.connections);
        self.coordinate(&scope, &profile.coordination);
        Composite {
            components: first..self.components.len(),
            exports: self.exports(&scope, profile),
        }
    }
}

/// The specification of an instance.
pub(super) fn component(
    profile: &ComponentProfile,
    subcomponent: &Subcomponent,
    name: String,
    node: &str,
) -> ComponentSpecification {
    let text = |property: &Property| (property.name.value.clone(), property.value.clone());
    let properties = profile.properties.iter().chain(&subcomponent.properties);
    let library = profile.environment.library_name.as_ref();
    ComponentSpecification {
        name,
        type_name: profile.header.name.value.clone(),
        profile: profile.header.file.clone(),
        place: subcomponent.name.place.clone(),
        library: library.map_or_else(String::new, |library| library.value.clone()),
        execution: profile.execution,
        properties: properties.map(text).collect(),
        ports: profile.ports.iter().map(|port| port.port.clone()).collect(),
        node: node.to_owned(),
    }
}

fn report_duplicate(scope: &Scope, name: &Located<String>) {
    let mut earlier = scope.members.iter().map(|(other, _)| other);
    if let Some(first) = earlier.find(|other| other.value == name.value && !name.value.is_empty()) {
        scope.file.document.report(
            Severity::Error,
            name,
            format!("a second subcomponent of the name {}", quoted(&name.value)),
            Some(format!(
                "the first one is at {}; give each a name of its own",
                first.place
            )),
        );
    }
}

fn report_missing_library(file: &LoadedFile, profile: &ComponentProfile) {
    if profile.environment.library_name.is_none() {
        file.document.report(
            Severity::Error,
            &profile.header.name,
            "the component names no library, so there is nothing to load",
            Some(
                "write <execution_environment><library_name>…</library_name></execution_environment>"
                    .into(),
            ),
        );
    }
}

fn report_unread_properties(file: &LoadedFile, subcomponent: &Subcomponent) {
    for property in &subcomponent.properties {
        file.document.report(
            Severity::Warning,
            &property.name,
            "a composite takes no properties",
            Some("set them on its members, in the composite's own file".into()),
        );
    }
}
