//! Behaviour trees: files of BehaviorTree.CPP (versions 3 and 4) and Nav2 as plain data, compiled into
//! plans and ticked.
//!
//! It reads no clock and no file, and starts no thread: a tick gets the time. [`Library`] takes what
//! files say ([`definition`]), looks everything up and collects every problem as a [`Finding`]; a
//! [`Plan`] is a tree with its sub-trees in place; a [`Tree`] is a plan at work. The work of leaves is
//! done by whoever implements [`Leaf`]; [`stub`] has leaves that only answer.
//!
//! The meaning is that of BehaviorTree.CPP 4:
//!
//! * Ticks are synchronous, from the root; a control node halts its children when it completes, so
//!   that they are idle when they begin again.
//! * A node that begins looks at `_failureIf`, `_successIf`, `_skipIf` and `_while`, in that order; a
//!   running one at `_while` alone, and is halted and skipped when it does not hold any more.
//! * SKIPPED goes to the parent, for which it is as if the node were not there; the node itself stays
//!   idle.
//! * A loop whose child completes at once answers RUNNING after each cycle, so no tick lasts for ever;
//!   [`Tree::is_woken`] tells.
//! * An error in a tick is no FAILURE: it goes to whoever ticks, and the tree is halted.
#![forbid(unsafe_code)]

mod blackboard;
pub mod catalogue;
mod compile;
pub mod component_nodes;
pub mod definition;
mod execute;
mod finding;
mod leaf;
mod plan;
mod script;
mod status;
pub mod stub;
mod tree;
mod value;

pub use compile::{CompileOptions, Library, MAX_NESTING, MAX_NODES};
pub use finding::Finding;
pub use leaf::{Leaf, LeafContext};
pub use plan::{NodeDescription, NodeId, Plan};
pub use script::{MAX_SCRIPT_DEPTH, Script, ScriptError};
pub use status::Status;
pub use tree::{MakeLeaf, Observer, TickError, Tree};
pub use value::Value;
