//! A file of behaviour trees as it was written: plain data with places, nothing looked up yet.

use system_model::profile::Located;

/// Which dialect of BehaviorTree.CPP a file is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// A file without `BTCPP_format`, or with 3.
    V3,
    /// `BTCPP_format="4"`.
    V4,
}

/// One file.
#[derive(Debug, Clone, PartialEq)]
pub struct TreeFile {
    /// The dialect of all that is in it.
    pub format: Format,
    /// `main_tree_to_execute`.
    pub main_tree: Option<Located<String>>,
    /// In document order.
    pub includes: Vec<Include>,
    /// In document order.
    pub trees: Vec<TreeDefinition>,
    /// What `TreeNodesModel` says of nodes; it is never executed.
    pub models: Vec<NodeModel>,
}

/// `<include path="..."/>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Include {
    /// Relative to the folder of the file that includes.
    pub path: Located<String>,
    /// The ROS package in which the path lies, if one is named.
    pub ros_package: Option<Located<String>>,
}

/// `<BehaviorTree ID="...">`.
#[derive(Debug, Clone, PartialEq)]
pub struct TreeDefinition {
    /// Its name; where the file gives none, `BehaviorTree`.
    pub id: Located<String>,
    /// Its one child; none if the file has none or several, which has been reported then.
    pub root: Option<NodeDefinition>,
}

/// How a node is spelt or what a model says it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NodeClass {
    /// A leaf that acts.
    Action,
    /// A leaf that only looks.
    Condition,
    /// A node of several children.
    Control,
    /// A node of one child.
    Decorator,
    /// Another tree in its place.
    SubTree,
}

impl NodeClass {
    /// All of them, as files write them.
    pub const ALL: [(&'static str, Self); 5] = [
        ("Action", Self::Action),
        ("Condition", Self::Condition),
        ("Control", Self::Control),
        ("Decorator", Self::Decorator),
        ("SubTree", Self::SubTree),
    ];

    /// The class of an element `<Action ID="...">` and its like.
    pub fn named(word: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(name, _)| *name == word);
        found.map(|(_, class)| *class)
    }

    /// The word in files.
    pub fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, class)| *class == self);
        found.map_or("", |(name, _)| name)
    }
}

/// One node of a tree, in either spelling.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeDefinition {
    /// The class, where the spelling says it: `<Action ID="Wait"/>`; not in `<Wait/>`.
    pub class: Option<NodeClass>,
    /// What kind of node it is, or which tree stands in its place.
    pub id: Located<String>,
    /// The instance's own name.
    pub name: Option<Located<String>>,
    /// Ports, and what begins with `_`; in document order.
    pub attributes: Vec<NodeAttribute>,
    /// In document order.
    pub children: Vec<NodeDefinition>,
}

/// One attribute.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeAttribute {
    /// The port, or `_skipIf` and its like.
    pub name: Located<String>,
    /// As written.
    pub value: Located<String>,
}

/// What a palette says of one kind of node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeModel {
    /// The kind.
    pub id: Located<String>,
    /// What it is.
    pub class: NodeClass,
    /// Its ports.
    pub ports: Vec<PortModel>,
}

/// One port of a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortModel {
    /// Its name.
    pub name: Located<String>,
    /// Which way data go.
    pub direction: Direction,
    /// What it is if a tree does not say; `{key}` as in a tree.
    pub default: Option<String>,
}

/// Which way data go, seen from the node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// `input_port`.
    Input,
    /// `output_port`.
    Output,
    /// `inout_port`.
    Both,
}
