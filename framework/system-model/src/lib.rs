//! The vocabulary of Steadfast as plain data: what a system is made of, before anything runs.
//!
//! Nothing here reads files, clocks or devices. `system-profile` produces these values from XML,
//! the container consumes them.

#![forbid(unsafe_code)]

pub mod data_type;
pub mod fault;
pub mod injection;
pub mod life_cycle;
pub mod mission;
pub mod network;
pub mod process_model;
pub mod profile;
pub mod rules;
pub mod specification;
pub mod task;
pub mod world;
