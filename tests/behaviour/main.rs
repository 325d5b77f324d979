//! What Steadfast promises, seen from outside.
#![forbid(unsafe_code)]

mod backtraces;
mod bad_files;
mod bad_libraries;
mod bench;
mod bench_overhead;
mod c_component;
mod clocks;
mod control;
mod costs;
mod events;
mod execution;
mod faults;
mod hangs;
mod help;
mod injections;
mod isolation;
mod life_cycle;
mod manager_ports;
mod memory;
mod new;
mod persistence;
mod ports;
mod readme;
mod recovery;
mod reference_model;
mod reference_robot;
mod scenarios;
mod services;
mod several_applications;
mod stopping;
mod supervised;
mod tidy;
mod trees;
mod two_cameras;
