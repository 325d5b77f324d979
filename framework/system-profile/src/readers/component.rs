//! `component_profile`: one component type.

use system_model::profile::{ComponentProfile, ExecutionEnvironment, Located, OperatingSystem};

use super::header::{self, attribute, text};
use super::{COMPONENT_RULES, execution, ports};
use crate::node::Node;

/// Reads a component profile.
pub(super) fn read(root: &Node<'_>) -> ComponentProfile {
    let (execution, remarks) = execution::read(root);
    root.pass_over(&["fsm"]);
    root.pass_over(&COMPONENT_RULES);
    ComponentProfile {
        header: header::read(root),
        environment: environment(root),
        execution,
        instance_creation: remarks.instance_creation,
        lifecycle_type: remarks.lifecycle_type,
        properties: header::properties(root),
        data_type_files: data_type_files(root),
        service_type_files: listed(root, "defined_service_types", "defined_service_type"),
        ports: ports::read(root),
    }
}

fn environment(root: &Node<'_>) -> ExecutionEnvironment {
    let Some(node) = root.child("execution_environment") else {
        return ExecutionEnvironment::default();
    };
    let systems = node.children("os").into_iter().map(|system| {
        let found = OperatingSystem {
            name: attribute(&system, "name"),
            version: attribute(&system, "version"),
        };
        system.finish();
        found
    });
    let environment = ExecutionEnvironment {
        operating_systems: systems.collect(),
        cpu: text(&node, "cpu"),
        library_type: text(&node, "library_type"),
        library_name: node.value("library_name").map(|value| value.located()),
        implementation_language: text(&node, "impl_language"),
        compiler: text(&node, "compiler"),
    };
    node.pass_over(&["app_domain", "app_robot"]);
    node.finish();
    environment
}

/// Tools write `defined_data_types`; the component specification calls it `data_type_list`.
fn data_type_files(root: &Node<'_>) -> Vec<Located<String>> {
    let mut files = listed(root, "defined_data_types", "defined_data_type");
    files.extend(listed(root, "data_type_list", "reference"));
    files
}

fn listed(root: &Node<'_>, list: &'static str, item: &'static str) -> Vec<Located<String>> {
    let Some(list) = root.child(list) else {
        return Vec::new();
    };
    let texts = list.children(item).into_iter().map(|node| {
        let value = node.text();
        node.finish();
        value
    });
    let files = texts
        .filter(|value| !value.is_empty())
        .map(|value| value.located())
        .collect();
    list.finish();
    files
}
