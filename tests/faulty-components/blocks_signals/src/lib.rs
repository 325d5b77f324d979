//! Blocks all signals by the C library, then spins for ever.
#![allow(unsafe_code)] // the misbehaviour itself

use std::mem;
use std::ptr;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct BlocksSignals;

impl Misbehaviour for BlocksSignals {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        // SAFETY: all zero is a set.
        let mut all: libc::sigset_t = unsafe { mem::zeroed() };
        // SAFETY: the set is ours.
        unsafe { libc::sigfillset(&raw mut all) };
        // SAFETY: as above.
        unsafe { libc::pthread_sigmask(libc::SIG_SETMASK, &raw const all, ptr::null_mut()) };
        // SAFETY: as above.
        unsafe { libc::sigprocmask(libc::SIG_BLOCK, &raw const all, ptr::null_mut()) };
        loop {
            std::hint::spin_loop();
        }
    }
}

export_component!(Faulty<BlocksSignals>);
