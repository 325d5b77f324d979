//! `data_type`: structures that data ports carry.

use system_model::profile::{DataTypeProfile, Field, Structure};

use super::header::required_attribute;
use crate::node::Node;

/// Reads a data type file.
pub(super) fn read(root: &Node<'_>) -> DataTypeProfile {
    DataTypeProfile {
        file: root.place().file,
        structures: root.children("struct").iter().map(structure).collect(),
    }
}

fn structure(node: &Node<'_>) -> Structure {
    let found = Structure {
        name: required_attribute(node, "name"),
        fields: node.children("item").iter().map(field).collect(),
    };
    node.finish();
    found
}

fn field(node: &Node<'_>) -> Field {
    let name = node.text();
    if name.is_empty() {
        node.error(
            "an item without a name",
            Some("the name is the text: <item type=\"double\">distance</item>".into()),
        );
    }
    let found = Field {
        name: name.located(),
        data_type: required_attribute(node, "type").value,
        default: node
            .attribute("default")
            .map(|value| value.as_str().to_owned()),
    };
    node.finish();
    found
}
