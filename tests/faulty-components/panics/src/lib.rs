//! Panics.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct Panics;

impl Misbehaviour for Panics {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        panic!("on purpose")
    }
}

export_component!(Faulty<Panics>);
