//! Executes an instruction that does not exist.
#![allow(unsafe_code)] // the misbehaviour itself

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct IllegalInstruction;

impl Misbehaviour for IllegalInstruction {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: none; the processor refuses it.
        unsafe {
            std::arch::asm!("ud2");
        }
        #[cfg(target_arch = "aarch64")]
        // SAFETY: none; the processor refuses it.
        unsafe {
            std::arch::asm!("udf #0");
        }
        Ok(())
    }
}

export_component!(Faulty<IllegalInstruction>);
