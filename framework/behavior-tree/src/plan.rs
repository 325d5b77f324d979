//! A tree with its sub-trees in place, names looked up and scripts parsed; plain data.

use std::collections::BTreeMap;
use std::ops::Range;

use system_model::specification::Place;

use crate::definition::NodeClass;
use crate::script::Script;
use crate::value::Value;

/// A node by its number in the order of the file, sub-trees in their places; the root is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub(crate) u32);

impl NodeId {
    /// The root of a plan.
    pub const ROOT: Self = Self(0);

    /// The number.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A tree that can be executed.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The tree's ID.
    pub id: String,
    pub(crate) nodes: Vec<Node>,
    pub(crate) descriptions: Vec<NodeDescription>,
    pub(crate) child_ids: Vec<NodeId>,
    pub(crate) entries: Vec<Entry>,
    /// Slots of the outermost blackboard.
    pub(crate) root_entries: BTreeMap<String, usize>,
    /// The nodes whose work somebody else does.
    pub(crate) leaves: Vec<NodeId>,
}

/// What every tick looks at.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    pub(crate) kind: Kind,
    /// Into `child_ids`.
    pub(crate) children: Range<u32>,
    /// Into `leaves`, for [`Kind::Leaf`].
    pub(crate) leaf: u32,
    pub(crate) ports: Box<[Source]>,
    pub(crate) conditions: Option<Box<Conditions>>,
    pub(crate) script: Option<Box<Script>>,
}

/// What is said of a node rather than done with it.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeDescription {
    /// Its kind, as files name it; of a sub-tree the ID of the tree.
    pub id: String,
    /// Its own name; where the file gives none, its kind.
    pub name: String,
    /// The names of all nodes from the root, with `/` between them. Where siblings have the same name,
    /// `::` and the position among them follow it.
    pub path: String,
    /// What it is.
    pub class: NodeClass,
    /// Whether nothing is known of its kind but the name.
    pub is_stub: bool,
    /// In the order of the node's declaration, else of the file; `None` where nothing was said.
    pub ports: Vec<(String, Option<String>)>,
    /// Where the values of the ports stand that the file gives.
    pub port_places: Vec<(String, Place)>,
    /// Pre- and post-conditions as written.
    pub conditions: Vec<(String, String)>,
    /// How deep it lies; the root is 0.
    pub depth: usize,
    /// Where it stands.
    pub place: Place,
}

/// Where a port gets its value, or leaves it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Source {
    Nothing,
    Literal(Value),
    Entry(usize),
}

/// Pre-conditions in the order in which they are looked at, and post-conditions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Conditions {
    pub(crate) failure_if: Option<Script>,
    pub(crate) success_if: Option<Script>,
    pub(crate) skip_if: Option<Script>,
    pub(crate) while_true: Option<Script>,
    pub(crate) on_success: Option<Script>,
    pub(crate) on_failure: Option<Script>,
    pub(crate) on_halted: Option<Script>,
    pub(crate) post: Option<Script>,
}

/// One slot of all blackboards.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) initial: Option<Value>,
    /// Whether a port or a sub-tree mentions it.
    pub(crate) is_declared: bool,
}

/// How a node works.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Sequence,
    AsyncSequence,
    SequenceWithMemory,
    ReactiveSequence,
    Fallback,
    AsyncFallback,
    ReactiveFallback,
    IfThenElse,
    WhileDoElse,
    TryCatch,
    Parallel,
    ParallelAll,
    Switch,
    Recovery,
    PipelineSequence,
    RoundRobin,
    NonblockingSequence,
    PersistentSequence,
    Module,
    Decider,
    Reactor,
    Inverter,
    ForceSuccess,
    ForceFailure,
    Repeat,
    Retry,
    Timeout,
    Delay,
    KeepRunningUntilFailure,
    RunOnce,
    Precondition,
    SkipUnlessUpdated,
    WaitValueUpdate,
    Loop,
    RateController,
    SingleTrigger,
    /// A sub-tree, and a decorator of which only the name is known.
    PassThrough,
    AlwaysSuccess,
    AlwaysFailure,
    Script,
    ScriptCondition,
    SetBlackboard,
    UnsetBlackboard,
    Sleep,
    WasEntryUpdated,
    /// Somebody else's work.
    Leaf,
}

impl Plan {
    /// How many nodes there are, sub-trees included.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no node, which does not happen to a compiled plan.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// All nodes, each before its children.
    pub fn node_ids(&self) -> impl Iterator<Item = NodeId> + use<> {
        // A plan has at most MAX_NODES nodes.
        (0..self.nodes.len() as u32).map(NodeId)
    }

    /// What is said of a node.
    pub fn describe(&self, node: NodeId) -> &NodeDescription {
        &self.descriptions[node.index()]
    }

    /// The children of a node, in order.
    pub fn children(&self, node: NodeId) -> &[NodeId] {
        let Range { start, end } = self.nodes[node.index()].children;
        &self.child_ids[start as usize..end as usize]
    }

    /// The nodes whose work somebody else does, each before those behind it in the file.
    pub fn leaves(&self) -> &[NodeId] {
        &self.leaves
    }

    /// What a port says before the first tick: a literal, or what an entry begins with (a sub-tree's
    /// attribute, for instance). None if that is not known.
    pub fn initial(&self, node: NodeId, port: &str) -> Option<&Value> {
        let ports = &self.describe(node).ports;
        let position = ports.iter().position(|(name, _)| name == port)?;
        match self.nodes[node.index()].ports.get(position)? {
            Source::Nothing => None,
            Source::Literal(value) => Some(value),
            Source::Entry(slot) => self.entries[*slot].initial.as_ref(),
        }
    }

    /// Whether a port refers to an entry of a blackboard.
    pub fn is_entry(&self, node: NodeId, port: &str) -> bool {
        let ports = &self.describe(node).ports;
        let position = ports.iter().position(|(name, _)| name == port);
        let source = position.and_then(|it| self.nodes[node.index()].ports.get(it));
        matches!(source, Some(Source::Entry(_)))
    }

    /// The keys of the outermost blackboard.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.root_entries.keys().map(String::as_str)
    }
}
