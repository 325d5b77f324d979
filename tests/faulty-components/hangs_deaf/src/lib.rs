//! Spins for ever and hears no signal: nothing can break it out.
#![allow(unsafe_code)] // the misbehaviour itself

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct HangsDeaf;

impl Misbehaviour for HangsDeaf {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        /// All of the kernel's 64 signals.
        const ALL: u64 = u64::MAX;
        let mask = ALL;
        let none = std::ptr::null_mut::<u64>();
        // SAFETY: the mask is as long as the kernel is told. By the system call itself: the
        // library's function is not the only way.
        unsafe {
            libc::syscall(
                libc::SYS_rt_sigprocmask,
                libc::SIG_BLOCK,
                &raw const mask,
                none,
                size_of_val(&mask),
            )
        };
        loop {
            std::hint::spin_loop();
        }
    }
}

export_component!(Faulty<HangsDeaf>);
