//! The commands of the binary, one file each.

pub mod bench;
pub mod check;
pub mod fault;
pub mod problems;
pub mod replay;
pub mod run;
pub mod world;
