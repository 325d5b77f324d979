//! Writes through a null pointer in a thread that it made.
#![allow(unsafe_code)] // that is the misbehaviour

use std::hint::black_box;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct CrashesInThread;

impl Misbehaviour for CrashesInThread {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        std::thread::spawn(|| {
            /// A field of a structure that is not there.
            const FIELD_OFFSET: usize = 8;
            let field: *mut u8 = black_box(std::ptr::without_provenance_mut(FIELD_OFFSET));
            // SAFETY: none; the first page is never mapped, so this traps.
            unsafe { field.write_volatile(1) };
        });
        Ok(())
    }
}

export_component!(Faulty<CrashesInThread>);
