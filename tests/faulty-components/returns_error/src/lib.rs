//! Returns an error.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct ReturnsError;

impl Misbehaviour for ReturnsError {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        Err(Failure::internal("on purpose"))
    }
}

export_component!(Faulty<ReturnsError>);
