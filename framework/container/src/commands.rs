//! The commands of the binary, one file each.

pub mod bench;
pub mod check;
pub mod component;
pub mod fault;
mod operator;
pub mod problems;
pub mod replay;
pub mod run;
pub mod status;
pub mod top;
mod words;
pub mod world;
