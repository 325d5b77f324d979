//! What the fault manager does, case by case.

#[path = "support/mod.rs"]
mod support;

#[path = "behaviour/correlation.rs"]
mod correlation;
#[path = "behaviour/debounce.rs"]
mod debounce;
#[path = "behaviour/graph.rs"]
mod graph;
#[path = "behaviour/ladder.rs"]
mod ladder;
#[path = "behaviour/life.rs"]
mod life;
#[path = "behaviour/operator.rs"]
mod operator;
#[path = "behaviour/trees.rs"]
mod trees;
#[path = "behaviour/what_if.rs"]
mod what_if;
