//! Writes through a null pointer: to a field of a structure that is not there.
#![allow(unsafe_code)] // the misbehaviour itself

use std::hint::black_box;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct WritesNull;

impl Misbehaviour for WritesNull {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        /// Where in the structure the field stands. Not 0: the standard library's debug checks
        /// would notice a null pointer and abort.
        const FIELD_OFFSET: usize = 8;
        let field: *mut u8 = black_box(std::ptr::without_provenance_mut(FIELD_OFFSET));
        // SAFETY: none; the first page is never mapped, so this traps.
        unsafe { field.write_volatile(1) };
        Ok(())
    }
}

export_component!(Faulty<WritesNull>);
