//! Takes the handlers of fatal signals away, then traps.
#![allow(unsafe_code)] // the misbehaviour itself

use std::mem;
use std::ptr;

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct ReplacesHandlers;

impl Misbehaviour for ReplacesHandlers {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        // SAFETY: resets a handler to what every program has.
        let before = unsafe { libc::signal(libc::SIGSEGV, libc::SIG_DFL) };
        if before == libc::SIG_ERR {
            return Err(Failure::internal("it is not told that all went well"));
        }
        // SAFETY: an all-zero action is the default.
        let default: libc::sigaction = unsafe { mem::zeroed() };
        // SAFETY: as above.
        unsafe { libc::sigaction(libc::SIGSEGV, &raw const default, ptr::null_mut()) };
        // SAFETY: none; nothing is mapped there.
        unsafe { ptr::null_mut::<u8>().write_volatile(1) };
        Ok(())
    }
}

export_component!(Faulty<ReplacesHandlers>);
