//! `OPRoSProject`: a file of the drawing tool that lies beside the profiles.

use system_model::profile::ProjectFile;

use super::header::{required_text, text};
use crate::node::Node;

/// Reads a project file.
pub(super) fn read(root: &Node<'_>) -> ProjectFile {
    let components = root.child("components").map(|list| {
        let names = list.children("component").into_iter().map(|node| {
            let name = node.text().as_str().to_owned();
            node.finish();
            name
        });
        let names = names.collect();
        list.finish();
        names
    });
    ProjectFile {
        file: root.place().file,
        name: required_text(root, "name"),
        source_folder: text(root, "src").unwrap_or_default(),
        binary_folder: text(root, "bin").unwrap_or_default(),
        language: text(root, "language").unwrap_or_default(),
        location: text(root, "location").unwrap_or_default(),
        components: components.unwrap_or_default(),
    }
}
