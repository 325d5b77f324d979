//! Recurses without end.
#![forbid(unsafe_code)]

use std::hint::black_box;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct OverflowsStack;

impl Misbehaviour for OverflowsStack {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        black_box(descend(1));
        Ok(())
    }
}

fn descend(depth: usize) -> usize {
    let room = black_box([depth; 64]);
    // The condition always holds, which the compiler is not told.
    if black_box(depth) > 0 {
        descend(depth + 1) + room[depth % 64]
    } else {
        depth
    }
}

export_component!(Faulty<OverflowsStack>);
