//! The rules that stand inline in profiles, read again from the files of an assembled application.

use std::rc::Rc;

use system_model::profile::{Located, Profile};
use system_model::rules::PortChecks;
use system_model::specification::ApplicationSpecification;

use super::Site;
use crate::node::Node;
use crate::readers::PROFILE_ROOTS;
use crate::readers::rules::{
    self, DeclaredComponent, DeclaredRules, EntityKind, application_elements, component_elements,
    composite_elements, dependencies, port_elements,
};
use crate::resolve::{Assembly, LoadedFile};

const PORTS: [&str; 3] = ["data_port", "event_port", "service_port"];

/// All inline rules of an application: of its component profiles, then of the subcomponents, which
/// are the integrator's and win.
pub(super) fn read(
    assembly: &Assembly<'_>,
    application: &ApplicationSpecification,
) -> DeclaredRules {
    let mut rules = DeclaredRules::default();
    for site in &assembly.sites {
        let name = instance_name(site);
        if let Some(component) = profile(&site.profile, &name) {
            rules.take(component);
        }
    }
    for site in &assembly.sites {
        if let Some(component) = subcomponent(site) {
            rules.take(component);
        }
    }
    let mut files = assembly.files.in_order().iter();
    if let Some(file) = files.find(|file| file.document.path() == application.file)
        && let (Some(Profile::Application(_)), Some(root)) =
            (&file.profile, file.document.root(&PROFILE_ROOTS))
    {
        rules.own = application_elements(&root);
        rules.dependencies.extend(dependencies(&root, None));
    }
    for (file, prefix) in &assembly.expanded {
        if let (Some(Profile::Composite(composite)), Some(root)) =
            (&file.profile, file.document.root(&PROFILE_ROOTS))
        {
            let name = &composite.header.name;
            rules
                .votings
                .extend(composite_elements(&root, name, prefix));
        }
    }
    rules
}

fn instance_name(site: &Site) -> Located<String> {
    let own = &site.subcomponent.name;
    Located {
        value: format!("{}{}", site.prefix, own.value),
        place: own.place.clone(),
    }
}

/// The rules in a component profile, for the instance of a name.
pub(super) fn profile(file: &Rc<LoadedFile>, name: &Located<String>) -> Option<DeclaredComponent> {
    let root = file.document.root(&PROFILE_ROOTS)?;
    let mut component = component_elements(&root, name);
    let lists = root.children("ports");
    for node in lists.iter().flat_map(|list| list.children_of(&PORTS)) {
        let checks = port_elements(&node);
        if checks != PortChecks::default()
            && let Some(name) = node.value("name")
        {
            component.ports.push((name.located(), checks));
        }
    }
    Some(component)
}

fn subcomponent(site: &Site) -> Option<DeclaredComponent> {
    let root = site.holder.document.root(&PROFILE_ROOTS)?;
    let lists = root.children("subcomponents");
    let is_meant = |node: &Node<'_>| {
        let name = node.children("name").into_iter().next();
        name.is_some_and(|name| name.text().place() == site.subcomponent.name.place)
    };
    let mut all = lists.iter().flat_map(|list| list.children("subcomponent"));
    let node = all.find(is_meant)?;
    Some(component_elements(&node, &instance_name(site)))
}

/// The dependencies in a system file, which are between applications unless they say otherwise.
pub(super) fn system(root: &Node<'_>) -> DeclaredRules {
    let mut rules = DeclaredRules::default();
    rules.dependencies = rules::dependencies(root, None);
    for dependency in &mut rules.dependencies {
        let names = std::iter::once(&mut dependency.dependent).chain(&mut dependency.references);
        for name in names {
            name.kind = name.kind.or(Some(EntityKind::Application));
        }
    }
    rules
}
