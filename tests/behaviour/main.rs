//! What Steadfast promises, seen from outside.
#![forbid(unsafe_code)]

mod backtraces;
mod bad_files;
mod bad_libraries;
mod c_component;
mod clocks;
mod control;
mod costs;
mod events;
mod execution;
mod faults;
mod hangs;
mod life_cycle;
mod memory;
mod ports;
mod readme;
mod reference_robot;
mod services;
mod stopping;
mod tidy;
