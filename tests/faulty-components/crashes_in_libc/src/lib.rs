//! Hands a bad address to the C library: the fault is outside the component's own code.
#![allow(unsafe_code)] // the misbehaviour itself

use std::hint::black_box;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct CrashesInLibc;

impl Misbehaviour for CrashesInLibc {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        /// In the first page, which is never mapped.
        const NOWHERE: usize = 64;
        let nowhere = black_box(std::ptr::without_provenance(NOWHERE));
        // SAFETY: none; the C library traps.
        black_box(unsafe { libc::strlen(nowhere) });
        Ok(())
    }
}

export_component!(Faulty<CrashesInLibc>);
