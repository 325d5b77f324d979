//! What all profiles have in common.

use std::collections::HashMap;

use system_model::profile::{Header, Located, Property};
use system_model::specification::Place;

use crate::node::Node;
use crate::suggest::quoted;

/// Name, identifier, version and description; the name is mandatory.
pub(super) fn read(root: &Node<'_>) -> Header {
    if let Some(copyright) = root.child("copyright") {
        read_copyright(&copyright);
    }
    Header {
        file: root.place().file,
        name: required_text(root, "name"),
        id: text(root, "id"),
        version: text(root, "version"),
        description: text(root, "description"),
    }
}

/// The copyright is informative; it is only looked through for misspellings.
fn read_copyright(copyright: &Node<'_>) {
    if let Some(company) = copyright.child("company") {
        company.pass_over(&["name", "phone", "fax", "address", "homepage"]);
        company.finish();
    }
    copyright.pass_over(&["license_policy", "version"]);
    copyright.finish();
}

/// The text of an optional child.
pub(super) fn text(node: &Node<'_>, name: &'static str) -> Option<String> {
    let value = node.value(name)?;
    Some(value.as_str().to_owned())
}

/// The text of a mandatory child; where it is missing the error is reported and the text empty.
pub(super) fn required_text(node: &Node<'_>, name: &'static str) -> Located<String> {
    let value = node.required_value(name);
    value.map_or_else(|| nameless(node), |value| value.located())
}

/// A mandatory attribute; where it is missing the error is reported and the text empty.
pub(super) fn required_attribute(node: &Node<'_>, name: &'static str) -> Located<String> {
    let value = node.required_attribute(name);
    value.map_or_else(|| nameless(node), |value| value.located())
}

/// An optional attribute, empty where it is missing.
pub(super) fn attribute(node: &Node<'_>, name: &'static str) -> String {
    let value = node.attribute(name);
    value.map_or_else(String::new, |value| value.as_str().to_owned())
}

fn nameless(node: &Node<'_>) -> Located<String> {
    Located {
        value: String::new(),
        place: node.place(),
    }
}

/// `properties/property` and its other name `exports/property`, in document order.
pub(super) fn properties(owner: &Node<'_>) -> Vec<Property> {
    let mut properties: Vec<Property> = Vec::new();
    let mut places = HashMap::new();
    for list in owner.children_of(&["properties", "exports"]) {
        for node in list.children("property") {
            let property = Property {
                name: required_attribute(&node, "name"),
                data_type: attribute(&node, "type"),
                value: node.text().as_str().to_owned(),
            };
            node.finish();
            let Located { value, place } = property.name.clone();
            if let Some(first) = places.insert(value, place) {
                warn_of_duplicate(&node, &property, &first);
            }
            properties.push(property);
        }
        list.finish();
    }
    properties
}

fn warn_of_duplicate(node: &Node<'_>, property: &Property, first: &Place) {
    node.warning(
        format!("property {} is set again", quoted(&property.name.value)),
        Some(format!(
            "this value wins over the one at {first}; remove one of them"
        )),
    );
}
