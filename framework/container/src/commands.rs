//! The commands of the binary, one file each.

pub mod adapt;
pub mod bench;
pub mod check;
pub mod completions;
mod exit_code;
pub mod fault;
pub mod man;
pub mod manual;
pub mod new;
mod output;
pub mod problems;
pub mod run;
pub mod schema;
pub mod world;

pub use exit_code::USAGE;
