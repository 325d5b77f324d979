//! Aborts in a thread that it made.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct AbortsInThread;

impl Misbehaviour for AbortsInThread {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        std::thread::spawn(|| std::process::abort());
        Ok(())
    }
}

export_component!(Faulty<AbortsInThread>);
