//! Asks the container for ever, for what is answered on the component's own stack.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour, Sample};

struct HangsAsking;

impl Misbehaviour for HangsAsking {
    fn misbehave(ports: &FaultyPorts) -> Outcome {
        loop {
            ports.output.write(&Sample::default());
        }
    }
}

export_component!(Faulty<HangsAsking>);
