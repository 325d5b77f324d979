//! The commands of the binary, one file each.

pub mod adapt;
pub mod bench;
pub mod check;
pub mod completions;
pub mod component;
mod exit_code;
pub mod explain;
pub mod fault;
pub mod graph;
pub mod man;
pub mod manual;
pub mod new;
mod operator;
mod output;
pub mod package;
pub mod problems;
pub mod replay;
pub mod report;
pub mod run;
pub mod schema;
pub mod status;
pub mod top;
pub mod tree;
mod words;
pub mod world;

pub use exit_code::USAGE;
