//! Allocates and releases for ever: most of the time it is in the C library's allocator.
#![forbid(unsafe_code)]

use std::hint::black_box;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct HangsAllocating;

impl Misbehaviour for HangsAllocating {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        let mut size = 1;
        loop {
            // Sizes of many of the allocator's classes.
            size = size * 5 % 4093;
            drop(black_box(vec![0u8; size]));
        }
    }
}

export_component!(Faulty<HangsAllocating>);
