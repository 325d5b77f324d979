//! What kind of node an element means.

use super::{CompileOptions, Library};
use crate::catalogue::{BUILT_IN, BuiltIn, built_in};
use crate::definition::{Format, NodeClass, NodeDefinition, NodeModel, TreeDefinition};
use crate::finding::Finding;

/// What a node is.
pub(super) enum Meaning<'a> {
    BuiltIn(&'static BuiltIn),
    SubTree(&'a TreeDefinition, Format),
    /// A node of somebody else's, with what is known of it.
    Custom(NodeClass, Option<&'a NodeModel>),
}

/// The meaning of a node; a finding where it has none.
pub(super) fn meaning<'a>(
    library: &Library<'a>,
    node: &NodeDefinition,
    format: Format,
    options: &CompileOptions,
) -> Result<Meaning<'a>, Box<Finding>> {
    let id = node.id.value.as_str();
    if node.class == Some(NodeClass::SubTree) {
        let found = library.trees.get(id);
        return match found {
            Some((tree, format)) => Ok(Meaning::SubTree(tree, *format)),
            None => Err(no_tree(library, node).into()),
        };
    }
    if let Some(found) = built_in(id, format) {
        return fits(node, found.class).map(|()| Meaning::BuiltIn(found));
    }
    if node.class.is_none()
        && let Some((tree, format)) = library.trees.get(id)
    {
        return Ok(Meaning::SubTree(tree, *format));
    }
    match library.models.get(id) {
        Some(model) if model.class == NodeClass::SubTree => Err(no_tree(library, node).into()),
        Some(model) => fits(node, model.class).map(|()| Meaning::Custom(model.class, Some(model))),
        None if options.stubs => Ok(Meaning::Custom(looks_like(node), None)),
        None => Err(unknown(library, node).into()),
    }
}

/// An element says `<Action ID="...">`, and the node must be one.
fn fits(node: &NodeDefinition, class: NodeClass) -> Result<(), Box<Finding>> {
    let is_leaf = |class| matches!(class, NodeClass::Action | NodeClass::Condition);
    match node.class {
        Some(said) if said != class && !(is_leaf(said) && is_leaf(class)) => Err(Finding::error(
            &node.id,
            format!(
                "{} is a {}, not a {}",
                node.id.value,
                class.name(),
                said.name()
            ),
            format!(
                "write <{}> or <{} ID=\"{}\">",
                node.id.value,
                class.name(),
                node.id.value
            ),
        )
        .into()),
        _ => Ok(()),
    }
}

fn looks_like(node: &NodeDefinition) -> NodeClass {
    match (node.class, node.children.len()) {
        (Some(class), _) => class,
        (None, 0) => NodeClass::Action,
        (None, 1) => NodeClass::Decorator,
        (None, _) => NodeClass::Control,
    }
}

fn no_tree(library: &Library<'_>, node: &NodeDefinition) -> Finding {
    Finding::error(
        &node.id,
        format!("there is no tree {}", node.id.value),
        "define it, or include the file that does",
    )
    .among(library.tree_ids())
}

fn unknown(library: &Library<'_>, node: &NodeDefinition) -> Finding {
    let built_in = BUILT_IN.iter().map(|node| node.id);
    let models = library.models.keys().copied();
    Finding::error(
        &node.id,
        format!("the node {} is not known", node.id.value),
        "describe it in <TreeNodesModel> of this file or of one given with --models, or use --stubs",
    )
    .among(built_in.chain(models).chain(library.tree_ids()))
}
