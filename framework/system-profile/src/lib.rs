//! Reads the XML files of Steadfast and OPRoS into the vocabulary of `system-model`.
//!
//! Bytes are decoded, parsed into a small tree that remembers where everything stood, and made
//! typed once. Every problem of a file is collected with its place and a line that says what to do.
//!
//! A reader for one more kind of file is a function over [`Document`] and [`Node`]; the example at
//! [`Document`] shows one.

#![forbid(unsafe_code)]

mod check;
mod decode;
mod document;
mod node;
pub mod parse;
mod problem;
mod readers;
mod reading;
mod resolve;
mod schema;
mod source;
mod suggest;
mod syntax;
pub mod tree;
mod trees;
mod value;
mod well_formed;

pub use check::{FileReport, check_file};
pub use document::{Document, MAX_FILE_SIZE};
pub use node::Node;
pub use problem::{MAX_PROBLEMS_PER_FILE, Problem, ProblemLog, Severity};
pub use readers::{
    PROFILE_ROOTS, ProcessModelOutcome, TaskOutcome, WorldOutcome, load_process_model, load_task,
    load_world, read_profile,
};
pub use reading::reading;
pub use resolve::{
    InjectionsOutcome, LoadOptions, LoadOutcome, RulesOutcome, find_component, load_application,
    load_injections, load_rules, read_injection,
};
pub use schema::{SCHEMAS, Schema};
pub use source::Source;
pub use trees::{TreeOptions, TreeOutcome, load_trees};
pub use value::{Number, Value};
