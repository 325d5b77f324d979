//! How long loading files of behaviour trees takes: those that `STEADFAST_TREES` names, with `:` in
//! between, each with the next one as its models; without it the one of the reference robot's mission.
#![allow(missing_docs)] // what the macros make

use std::path::{Path, PathBuf};

use behavior_tree::CompileOptions;
use criterion::{Criterion, criterion_group, criterion_main};
use system_profile::{TreeOptions, load_trees};

const MISSION: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../profiles/trees/inspection_mission.xml"
);

fn loading(criterion: &mut Criterion) {
    let named = std::env::var("STEADFAST_TREES").unwrap_or_else(|_| MISSION.to_owned());
    let mut files = named.split(':').map(PathBuf::from);
    let Some(file) = files.next() else { return };
    let options = TreeOptions {
        compile: CompileOptions {
            stubs: true,
            ..CompileOptions::default()
        },
        models: files.collect(),
        ..TreeOptions::default()
    };
    let nodes = load_trees(&file, &options)
        .plan
        .map_or(0, |plan| plan.len());
    let name = file.file_name().map(Path::new).unwrap_or(&file).display();
    let name = format!("loading {name}, {nodes} nodes");
    criterion.bench_function(&name, |bencher| {
        bencher.iter(|| load_trees(&file, &options));
    });
}

criterion_group!(benches, loading);
criterion_main!(benches);
