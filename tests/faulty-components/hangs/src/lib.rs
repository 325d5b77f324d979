//! Spins for ever.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct Hangs;

impl Misbehaviour for Hangs {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        loop {
            std::hint::spin_loop();
        }
    }
}

export_component!(Faulty<Hangs>);
