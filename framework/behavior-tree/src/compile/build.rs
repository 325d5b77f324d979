//! A tree with its sub-trees in place.

use std::collections::BTreeMap;

use system_model::profile::Located;

use super::attributes::{Ports, port_attributes};
use super::classify::{Meaning, meaning};
use super::scope::{ScopeId, Scopes, key_of};
use super::{CompileOptions, Library, MAX_NESTING, MAX_NODES, is_needed};
use crate::definition::{Format, NodeClass, NodeDefinition, NodeModel, TreeDefinition};
use crate::finding::Finding;
use crate::plan::{Kind, Node, NodeDescription, NodeId, Plan};
use crate::value::Value;

pub(super) fn compile(
    library: &Library<'_>,
    tree: &TreeDefinition,
    options: &CompileOptions,
) -> (Option<Plan>, Vec<Finding>) {
    let mut builder = Builder {
        library,
        options,
        scopes: Scopes::default(),
        findings: Vec::new(),
        nodes: Vec::new(),
        descriptions: Vec::new(),
        child_ids: Vec::new(),
        leaves: Vec::new(),
        open_trees: vec![tree.id.value.clone()],
        is_full: false,
    };
    let format = library.trees[tree.id.value.as_str()].1;
    let scope = builder.scopes.open(None, false);
    if let Some(root) = &tree.root {
        let place = Surroundings {
            scope,
            format,
            depth: 0,
            path: tree.id.value.clone(),
            number: None,
        };
        builder.node(root, &place);
    }
    let is_whole = !builder.findings.iter().any(|finding| finding.is_error);
    let plan = (is_whole && !builder.nodes.is_empty()).then(|| Plan {
        id: tree.id.value.clone(),
        nodes: builder.nodes,
        descriptions: builder.descriptions,
        child_ids: builder.child_ids,
        root_entries: builder.scopes.root_slots(),
        entries: builder.scopes.entries,
        leaves: builder.leaves,
    });
    (plan, builder.findings)
}

pub(super) struct Builder<'l, 'a> {
    library: &'l Library<'a>,
    pub(super) options: &'l CompileOptions,
    pub(super) scopes: Scopes,
    pub(super) findings: Vec<Finding>,
    nodes: Vec<Node>,
    descriptions: Vec<NodeDescription>,
    child_ids: Vec<NodeId>,
    leaves: Vec<NodeId>,
    /// The trees in each other that the node stands in.
    open_trees: Vec<String>,
    is_full: bool,
}

/// Where a node stands.
struct Surroundings {
    scope: ScopeId,
    format: Format,
    depth: usize,
    /// Of the parent.
    path: String,
    /// Among siblings of the same name, from 1.
    number: Option<usize>,
}

/// What a node was found to be.
struct Resolved<'a> {
    kind: Kind,
    class: NodeClass,
    children: (usize, usize),
    ports: Ports,
    is_stub: bool,
    sub_tree: Option<(&'a TreeDefinition, Format)>,
}

impl<'a> Builder<'_, 'a> {
    /// Adds a node and all below it. After an error the children are looked through all the same.
    fn node(&mut self, node: &NodeDefinition, place: &Surroundings) -> Option<NodeId> {
        if !self.has_room(node, place.depth) {
            return None;
        }
        let resolved = match meaning(self.library, node, place.format, self.options) {
            Ok(meaning) => self.resolve(meaning, node, place),
            Err(finding) => {
                self.findings.push(*finding);
                None
            }
        };
        let Some(resolved) = resolved else {
            self.children(node, place);
            return None;
        };
        self.check_count(node, &resolved);
        let conditions = self.conditions(node, place.scope);
        let description = describe(node, &resolved, place);
        // MAX_NODES are far fewer than u32 can count.
        let id = NodeId(self.nodes.len() as u32);
        self.nodes.push(Node {
            kind: resolved.kind,
            children: 0..0,
            leaf: self.leaves.len() as u32,
            ports: resolved.ports.sources.into(),
            conditions,
            script: resolved.ports.script,
        });
        if resolved.kind == Kind::Leaf {
            self.leaves.push(id);
        }
        let path = description.path.clone();
        self.descriptions.push(description);
        let below = Surroundings {
            path,
            depth: place.depth + 1,
            number: None,
            ..*place
        };
        let children = match resolved.sub_tree {
            Some((tree, format)) => self.sub_tree(node, tree, format, &below),
            None => self.children(node, &below),
        };
        let start = self.child_ids.len() as u32;
        self.child_ids.extend(children);
        self.nodes[id.index()].children = start..self.child_ids.len() as u32;
        Some(id)
    }

    fn resolve(
        &mut self,
        meaning: Meaning<'a>,
        node: &NodeDefinition,
        place: &Surroundings,
    ) -> Option<Resolved<'a>> {
        Some(match meaning {
            Meaning::BuiltIn(built_in) => Resolved {
                kind: built_in.kind,
                class: built_in.class,
                children: built_in.children,
                ports: self.built_in_ports(built_in, node, place.scope, place.format),
                is_stub: false,
                sub_tree: None,
            },
            Meaning::SubTree(tree, format) => {
                if self.open_trees.contains(&tree.id.value) {
                    self.findings.push(Finding::error(
                        &node.id,
                        format!("the tree {} contains itself", tree.id.value),
                        "a tree cannot be its own sub-tree: repeat it with a decorator instead",
                    ));
                    return None;
                }
                Resolved {
                    kind: Kind::PassThrough,
                    class: NodeClass::SubTree,
                    children: (0, 0),
                    ports: Ports::default(),
                    is_stub: false,
                    sub_tree: Some((tree, format)),
                }
            }
            Meaning::Custom(class, model) => self.custom(class, model, node, place),
        })
    }

    fn custom(
        &mut self,
        class: NodeClass,
        model: Option<&NodeModel>,
        node: &NodeDefinition,
        place: &Surroundings,
    ) -> Resolved<'a> {
        let (kind, children) = match class {
            NodeClass::Control => (Kind::Sequence, (1, usize::MAX)),
            NodeClass::Decorator => (Kind::PassThrough, (1, 1)),
            _ => (Kind::Leaf, (0, 0)),
        };
        if kind != Kind::Leaf {
            let like = match kind {
                Kind::Sequence => "a Sequence",
                _ => "one that passes on what its child answers",
            };
            self.findings.push(Finding::warning(
                &node.id,
                format!("{} is not built in, and is taken for {like}", node.id.value),
                "what it really does is not known here",
            ));
        }
        Resolved {
            kind,
            class,
            children,
            ports: self.custom_ports(model, node, place.scope),
            is_stub: model.is_none(),
            sub_tree: None,
        }
    }

    fn children<'n>(&mut self, node: &'n NodeDefinition, place: &Surroundings) -> Vec<NodeId> {
        let name = |child: &'n NodeDefinition| &child.name.as_ref().unwrap_or(&child.id).value;
        let mut alike: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
        for child in &node.children {
            alike.entry(name(child)).or_default().0 += 1;
        }
        let ids = node.children.iter().filter_map(|child| {
            let (all, so_far) = alike.entry(name(child)).or_default();
            *so_far += 1;
            let number = (*all > 1).then_some(*so_far);
            let path = place.path.clone();
            let below = Surroundings {
                number,
                path,
                ..*place
            };
            self.node(child, &below)
        });
        ids.collect()
    }

    fn sub_tree(
        &mut self,
        node: &NodeDefinition,
        tree: &TreeDefinition,
        format: Format,
        place: &Surroundings,
    ) -> Vec<NodeId> {
        let remaps_all = node.attributes.iter().any(|attribute| {
            attribute.name.value == "_autoremap"
                && matches!(attribute.value.value.trim(), "1" | "true")
        });
        let scope = self.scopes.open(Some(place.scope), remaps_all);
        for attribute in port_attributes(node) {
            self.bind(scope, &attribute.name.value, &attribute.value.value);
        }
        let model = self.library.sub_tree_model(&tree.id.value);
        for port in model.iter().flat_map(|model| &model.ports) {
            let name = &port.name.value;
            let is_said = port_attributes(node).any(|attribute| attribute.name.value == *name);
            match &port.default {
                Some(default) if !is_said => self.bind(scope, name, default),
                _ if !is_said && !remaps_all && is_needed(port) => {
                    self.findings.push(Finding::error(
                        &node.id,
                        format!("the tree {} needs {name}", tree.id.value),
                        format!("write {name}=\"…\""),
                    ));
                }
                _ => {}
            }
        }
        let Some(root) = &tree.root else {
            return Vec::new();
        };
        self.open_trees.push(tree.id.value.clone());
        let below = Surroundings {
            scope,
            format,
            depth: place.depth,
            path: place.path.clone(),
            number: None,
        };
        let child = self.node(root, &below);
        self.open_trees.pop();
        child.into_iter().collect()
    }

    fn bind(&mut self, scope: ScopeId, key: &str, value: &str) {
        match key_of(key, value) {
            Some(parents_key) => self.scopes.remap(scope, key, parents_key),
            None => self.scopes.preset(scope, key, Value::of_literal(value)),
        }
    }

    fn has_room(&mut self, node: &NodeDefinition, depth: usize) -> bool {
        let (message, help) = if depth >= MAX_NESTING {
            (
                format!("more than {MAX_NESTING} nodes in each other"),
                "sub-trees count where they stand: make the tree flatter",
            )
        } else if self.nodes.len() >= MAX_NODES {
            (
                format!("more than {MAX_NODES} nodes"),
                "sub-trees count each time they are used: use fewer of them",
            )
        } else {
            return true;
        };
        // Said once, not for every node that follows.
        if !self.is_full {
            self.findings.push(Finding::error(&node.id, message, help));
        }
        self.is_full = true;
        false
    }

    fn check_count(&mut self, node: &NodeDefinition, resolved: &Resolved<'_>) {
        let (fewest, most) = resolved.children;
        let found = node.children.len();
        if (fewest..=most).contains(&found) {
            return;
        }
        let expected = match (fewest, most) {
            (0, 0) => "none".to_owned(),
            (1, 1) => "one".to_owned(),
            (fewest, usize::MAX) => format!("at least {fewest}"),
            (fewest, most) if fewest == most => format!("{fewest}"),
            (fewest, most) => format!("{fewest} to {most}"),
        };
        let id = &node.id.value;
        self.findings.push(Finding::error(
            &node.id,
            format!("{id} has {}, and must have {expected}", children(found)),
            "move, add or remove nodes below it",
        ));
    }
}

fn describe(
    node: &NodeDefinition,
    resolved: &Resolved<'_>,
    place: &Surroundings,
) -> NodeDescription {
    let text = |located: &Located<String>| located.value.clone();
    let name = node.name.as_ref().map_or_else(|| text(&node.id), text);
    let is_condition = |name: &str| super::attributes::CONDITIONS.contains(&name);
    let attributes = node.attributes.iter();
    let ports = match resolved.sub_tree {
        Some(_) => port_attributes(node)
            .map(|it| (text(&it.name), Some(text(&it.value))))
            .collect(),
        None => resolved.ports.described.clone(),
    };
    NodeDescription {
        id: text(&node.id),
        path: match place.number {
            None => format!("{}/{name}", place.path),
            Some(number) => format!("{}/{name}::{number}", place.path),
        },
        name,
        class: resolved.class,
        is_stub: resolved.is_stub,
        ports,
        port_places: port_attributes(node)
            .map(|it| (text(&it.name), it.value.place.clone()))
            .collect(),
        conditions: attributes
            .filter(|it| is_condition(&it.name.value))
            .map(|it| (text(&it.name), text(&it.value)))
            .collect(),
        depth: place.depth,
        place: node.id.place.clone(),
    }
}

fn children(count: usize) -> String {
    match count {
        0 => "no child".to_owned(),
        1 => "1 child".to_owned(),
        _ => format!("{count} children"),
    }
}
