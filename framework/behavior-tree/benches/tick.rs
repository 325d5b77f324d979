//! How long a tick of a tree of 1000 nodes takes.
#![allow(missing_docs)] // what the macros make

use std::sync::Arc;
use std::time::Duration;

use behavior_tree::definition::{Format, NodeDefinition, TreeDefinition, TreeFile};
use behavior_tree::{CompileOptions, Library, NodeId, Status, Tree};
use criterion::{Criterion, criterion_group, criterion_main};
use system_model::profile::Located;
use system_model::specification::Place;

fn located(text: &str) -> Located<String> {
    Located {
        value: text.to_owned(),
        place: Place::default(),
    }
}

fn node(id: &str, children: Vec<NodeDefinition>) -> NodeDefinition {
    NodeDefinition {
        class: None,
        id: located(id),
        name: None,
        attributes: Vec::new(),
        children,
    }
}

/// A sequence of `branches` fallbacks, each of three inverted successes and a success, all of which
/// are ticked: 8 nodes a branch.
fn tree(branches: usize) -> Tree {
    let inverted = || node("Inverter", vec![node("AlwaysSuccess", Vec::new())]);
    let branch = || {
        let success = node("AlwaysSuccess", Vec::new());
        node(
            "Fallback",
            vec![inverted(), inverted(), inverted(), success],
        )
    };
    let root = node(
        "ReactiveSequence",
        (0..branches).map(|_| branch()).collect(),
    );
    let file = TreeFile {
        format: Format::V4,
        main_tree: None,
        includes: Vec::new(),
        trees: vec![TreeDefinition {
            id: located("Main"),
            root: Some(root),
        }],
        models: Vec::new(),
    };
    let (library, _) = Library::new([&file]);
    let plan = library.compile("Main", &CompileOptions::default()).0;
    let plan = plan.expect("the tree has no mistakes");
    let none = &mut |_: &_, _| Err("there are no leaves of others".to_owned());
    Tree::new(Arc::new(plan), none).expect("no leaf is asked for")
}

fn ticks(criterion: &mut Criterion) {
    let mut ignored = |_node: NodeId, _before: Status, _now: Status| {};
    // 1 + 125 * 8 = 1001 nodes, each of which is ticked in each tick.
    let mut tree = tree(125);
    criterion.bench_function("tick of 1001 nodes", |bencher| {
        bencher.iter(|| tree.tick(Duration::ZERO, &mut ignored));
    });
}

criterion_group!(benches, ticks);
criterion_main!(benches);
