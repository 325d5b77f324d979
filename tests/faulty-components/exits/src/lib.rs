//! Calls `exit`.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct Exits;

impl Misbehaviour for Exits {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        std::process::exit(7)
    }
}

export_component!(Faulty<Exits>);
