//! Sleeps in the C library for ever.
#![forbid(unsafe_code)]

use std::time::Duration;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct HangsAsleep;

impl Misbehaviour for HangsAsleep {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        // One sleep that signals interrupt and the library takes up again: it never comes back
        // into the component's own code.
        std::thread::sleep(Duration::MAX);
        Ok(())
    }
}

export_component!(Faulty<HangsAsleep>);
