//! Divides by zero, by the processor's own instruction: Rust's operator would panic.
#![allow(unsafe_code)] // the misbehaviour itself

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct DividesByZero;

impl Misbehaviour for DividesByZero {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        divide();
        Ok(())
    }
}

#[cfg(target_arch = "x86_64")]
fn divide() {
    // SAFETY: none; the processor raises a division error.
    unsafe {
        std::arch::asm!(
            "div {divisor:e}",
            divisor = in(reg) 0_u32,
            inout("eax") 1_u32 => _,
            inout("edx") 0_u32 => _,
        );
    }
}

/// Processors whose division answers 0 have no such trap; the signal alone stands for it.
#[cfg(not(target_arch = "x86_64"))]
fn divide() {
    // SAFETY: no precondition.
    unsafe { libc::raise(libc::SIGFPE) };
}

export_component!(Faulty<DividesByZero>);
