//! Passes memory to a host service that is not there.
#![allow(unsafe_code)] // the misbehaviour itself

use std::hint::black_box;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour, Sample};

struct BadPointer;

impl Misbehaviour for BadPointer {
    fn misbehave(ports: &FaultyPorts) -> Outcome {
        /// In the first page, which is never mapped; aligned for the datum.
        const NOWHERE: usize = 64;
        let nowhere: *const Sample = black_box(std::ptr::without_provenance(NOWHERE));
        // SAFETY: none; the container must find that out when it copies the datum.
        ports.output.write(unsafe { &*nowhere });
        Ok(())
    }
}

export_component!(Faulty<BadPointer>);
