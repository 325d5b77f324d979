//! Files to plans: everything is looked up, and every problem collected.

mod attributes;
mod build;
mod classify;
mod scope;

use std::collections::{BTreeMap, BTreeSet};

use crate::component_nodes;
use crate::definition::{
    Direction, Format, NodeClass, NodeDefinition, NodeModel, TreeDefinition, TreeFile,
};
use crate::finding::Finding;
use crate::plan::Plan;
use crate::value::Value;

/// The largest public tree has 60 nodes; what is larger than this, sub-trees in their places, was
/// not written by people and takes hundreds of megabytes.
pub const MAX_NODES: usize = 20_000;

/// Nodes in each other, sub-trees in their places. A tick and a halt need about a kilobyte of stack
/// for each.
pub const MAX_NESTING: usize = 200;

/// How trees are compiled.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CompileOptions {
    /// Nodes of which nothing is known are taken for what their children make them look like.
    pub stubs: bool,
    /// Names that scripts, and the cases of a Switch, may use for values.
    pub constants: BTreeMap<String, Value>,
}

/// The trees and models of one or several files.
#[derive(Debug)]
pub struct Library<'a> {
    trees: BTreeMap<&'a str, (&'a TreeDefinition, Format)>,
    models: BTreeMap<&'a str, &'a NodeModel>,
}

impl<'a> Library<'a> {
    /// Gathers what files hold, with what is wrong with that.
    pub fn new(files: impl IntoIterator<Item = &'a TreeFile>) -> (Self, Vec<Finding>) {
        let mut library = Self {
            trees: BTreeMap::new(),
            models: BTreeMap::new(),
        };
        let mut findings = Vec::new();
        let models = component_nodes::models().iter();
        let own: BTreeMap<&'a str, &'a NodeModel> = models
            .map(|model| (model.id.value.as_str(), model))
            .collect();
        for file in files {
            for tree in &file.trees {
                let id = tree.id.value.as_str();
                if let Some((first, _)) = library.trees.get(id) {
                    findings.push(Finding::error(
                        &tree.id,
                        format!("a second tree {id}"),
                        format!("the first one is at {}; rename one", first.id.place),
                    ));
                    continue;
                }
                library.trees.insert(id, (tree, file.format));
            }
            for model in &file.models {
                library.models.entry(&model.id.value).or_insert(model);
            }
        }
        for (id, model) in own {
            library.models.entry(id).or_insert(model);
        }
        (library, findings)
    }

    /// The IDs of all trees, in alphabetical order.
    pub fn tree_ids(&self) -> impl Iterator<Item = &str> {
        self.trees.keys().copied()
    }

    /// Compiles a tree with all its sub-trees in place. Without an error among the findings there is
    /// a plan; an unknown ID has neither.
    pub fn compile(&self, id: &str, options: &CompileOptions) -> (Option<Plan>, Vec<Finding>) {
        match self.trees.get(id) {
            Some((tree, _)) => build::compile(self, tree, options),
            None => (None, Vec::new()),
        }
    }

    /// What is wrong with any tree.
    pub fn check(&self, options: &CompileOptions) -> Vec<Finding> {
        // A tree in another's place is looked through there; those in a circle are in no place.
        let mut inner = BTreeSet::new();
        for (tree, _) in self.trees.values() {
            if let Some(root) = &tree.root {
                sub_trees(root, &mut inner);
            }
        }
        let mut findings = Vec::new();
        for id in self.tree_ids() {
            let is_alone = !inner.contains(id) || self.is_in_circle(id);
            if is_alone {
                findings.extend(self.compile(id, options).1);
            }
        }
        findings
    }

    /// Whether a tree has itself for a sub-tree, directly or not.
    fn is_in_circle(&self, id: &str) -> bool {
        let mut open = vec![id];
        let mut seen = BTreeSet::new();
        while let Some(next) = open.pop() {
            let Some((tree, _)) = self.trees.get(next) else {
                continue;
            };
            let mut inner = BTreeSet::new();
            if let Some(root) = &tree.root {
                sub_trees(root, &mut inner);
            }
            if inner.contains(id) {
                return true;
            }
            open.extend(inner.into_iter().filter(|it| seen.insert(*it)));
        }
        false
    }

    fn sub_tree_model(&self, id: &str) -> Option<&'a NodeModel> {
        let model = self.models.get(id).copied();
        model.filter(|model| model.class == NodeClass::SubTree)
    }
}

/// The IDs of nodes that may stand for a tree.
fn sub_trees<'a>(node: &'a NodeDefinition, into: &mut BTreeSet<&'a str>) {
    let is_compact = node.class.is_none();
    if is_compact || node.class == Some(NodeClass::SubTree) {
        into.insert(&node.id.value);
    }
    for child in &node.children {
        sub_trees(child, into);
    }
}

/// Whether a port of a sub-tree's model brings something in that the tree needs.
fn is_needed(port: &crate::definition::PortModel) -> bool {
    port.direction == Direction::Input && port.default.is_none()
}
