//! `service_port_type_profile`: types of service ports.

use system_model::profile::{
    CallType, ServiceMethod, ServiceParameter, ServiceType, ServiceTypeProfile,
};

use super::header::{attribute, required_attribute, required_text, text};
use crate::node::Node;

/// Reads a service type file.
pub(super) fn read(root: &Node<'_>) -> ServiceTypeProfile {
    ServiceTypeProfile {
        file: root.place().file,
        types: root
            .children("service_port_type")
            .iter()
            .map(service_type)
            .collect(),
    }
}

fn service_type(node: &Node<'_>) -> ServiceType {
    let found = ServiceType {
        name: required_text(node, "type_name"),
        methods: node.children("method").iter().map(method).collect(),
    };
    node.pass_over(&["description"]);
    node.finish();
    found
}

fn method(node: &Node<'_>) -> ServiceMethod {
    let call = node.attribute("call_type").and_then(|value| {
        value.choice(&[
            ("blocking", CallType::Blocking),
            ("nonblocking", CallType::Nonblocking),
        ])
    });
    let found = ServiceMethod {
        name: required_attribute(node, "name"),
        return_type: attribute(node, "return_type"),
        call: call.unwrap_or_default(),
        parameters: node.children("param").iter().map(parameter).collect(),
    };
    node.pass_over(&["description"]);
    node.pass_over_attributes(&["description"]);
    node.finish();
    found
}

fn parameter(node: &Node<'_>) -> ServiceParameter {
    let found = ServiceParameter {
        index: attribute(node, "index"),
        name: text(node, "name").unwrap_or_default(),
        data_type: required_text(node, "type").value,
        default: text(node, "default"),
    };
    node.pass_over(&["description"]);
    node.finish();
    found
}
