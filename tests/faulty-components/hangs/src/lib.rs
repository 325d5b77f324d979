//! Never returns.
#![forbid(unsafe_code)]

use std::time::Duration;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct Hangs;

impl Misbehaviour for Hangs {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        loop {
            std::thread::sleep(Duration::from_secs(1));
        }
    }
}

export_component!(Faulty<Hangs>);
