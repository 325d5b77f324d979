//! Panics again while it unwinds, which Rust answers by `abort`.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct DoublePanics;

struct PanicsWhenDropped;

impl Drop for PanicsWhenDropped {
    fn drop(&mut self) {
        panic!("the second, while the first unwinds")
    }
}

impl Misbehaviour for DoublePanics {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        let _panics = PanicsWhenDropped;
        panic!("the first")
    }
}

export_component!(Faulty<DoublePanics>);
