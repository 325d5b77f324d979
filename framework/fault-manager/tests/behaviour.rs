//! What the fault manager does, case by case.

#[path = "support/mod.rs"]
mod support;

#[path = "behaviour/graph.rs"]
mod graph;
#[path = "behaviour/ladder.rs"]
mod ladder;
