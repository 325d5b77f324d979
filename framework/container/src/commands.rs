//! The commands of the binary, one file each.

pub mod bench;
pub mod check;
pub mod explain;
pub mod fault;
pub mod graph;
mod output;
pub mod problems;
pub mod run;
pub mod world;
