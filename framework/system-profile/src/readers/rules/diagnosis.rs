//! The elements that say how much a fault matters, and to whom.

use system_model::profile::Located;
use system_model::rules::{ApplicationSeverity, ComponentSeverity, DependencySeverity};

use super::declared::{DeclaredDependency, DeclaredName, EntityKind};
use super::measure::{count, setting};
use crate::node::Node;
use crate::value::Value;

pub(in crate::readers) const COMPONENT_SEVERITIES: [(&str, ComponentSeverity); 4] = [
    ("ignore", ComponentSeverity::Ignore),
    ("reset", ComponentSeverity::Reset),
    ("stop", ComponentSeverity::Stop),
    ("emergency", ComponentSeverity::Emergency),
];

pub(super) const APPLICATION_SEVERITIES: [(&str, ApplicationSeverity); 3] = [
    ("ignore", ApplicationSeverity::Ignore),
    ("local", ApplicationSeverity::Local),
    ("global", ApplicationSeverity::Global),
];

const DEPENDENCY_SEVERITIES: [(&str, DependencySeverity); 3] = [
    ("ignore", DependencySeverity::Ignore),
    ("stop", DependencySeverity::Stop),
    ("destroy", DependencySeverity::Destroy),
];

const KINDS: [(&str, EntityKind); 3] = [
    ("component", EntityKind::Component),
    ("executor", EntityKind::Executor),
    ("application", EntityKind::Application),
];

/// `severity` of a component.
pub(super) fn component_severity(node: &Node<'_>) -> Option<Located<ComponentSeverity>> {
    let child = node.child("severity")?;
    let value = child.text();
    child.finish();
    Some(Located {
        value: value.choice(&COMPONENT_SEVERITIES)?,
        place: value.place(),
    })
}

/// `dependency`. The dependent is named unless the dependency stands in it.
pub(super) fn dependency(
    node: &Node<'_>,
    dependent: Option<&Located<String>>,
) -> Option<DeclaredDependency> {
    let severity = setting(node, "severity").map(|value| value.choice(&DEPENDENCY_SEVERITIES));
    let need = setting(node, "need").map(|value| count(&value, 1));
    let dependent = match dependent {
        Some(dependent) => Some(DeclaredName {
            name: dependent.clone(),
            kind: None,
        }),
        None => named(node),
    };
    let references = node.children("reference");
    let references: Vec<_> = references.iter().filter_map(entity).collect();
    if references.is_empty() {
        node.error(
            "a dependency on nobody",
            Some("write <reference>…</reference> with the name of what is needed".into()),
        );
    }
    node.finish();
    let all = references.len();
    let need = match need {
        Some(need) => usize::try_from(need?).unwrap_or(usize::MAX),
        None => all,
    };
    Some(DeclaredDependency {
        place: node.place(),
        dependent: dependent?,
        need,
        severity: severity.unwrap_or_else(|| Some(DependencySeverity::default()))?,
        references: (!references.is_empty()).then_some(references)?,
    })
}

fn named(node: &Node<'_>) -> Option<DeclaredName> {
    match node.attribute("name") {
        Some(name) => Some(DeclaredName {
            name: name.located(),
            kind: None,
        }),
        None => entity(&node.required_child("name")?),
    }
}

fn entity(node: &Node<'_>) -> Option<DeclaredName> {
    let kind = node.attribute("kind").map(|value| value.choice(&KINDS));
    let name: Value<'_> = node.text();
    node.finish();
    if name.is_empty() {
        node.error(
            format!("<{}> is empty", node.name()),
            Some("write the name of a component, an executor or an application".into()),
        );
        return None;
    }
    Some(DeclaredName {
        name: name.located(),
        kind: match kind {
            Some(kind) => Some(kind?),
            None => None,
        },
    })
}
