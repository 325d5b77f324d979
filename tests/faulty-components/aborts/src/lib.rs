//! Calls `abort`.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct Aborts;

impl Misbehaviour for Aborts {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        std::process::abort()
    }
}

export_component!(Faulty<Aborts>);
