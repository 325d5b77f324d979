//! Asks for name spaces of its own, but for none in particular: a system call without effect that a
//! process of its own is refused.
#![allow(unsafe_code)] // the misbehaviour itself

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct LeavesNamespace;

impl Misbehaviour for LeavesNamespace {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        // SAFETY: no flag: nothing is changed.
        if unsafe { libc::unshare(0) } == 0 {
            return Ok(());
        }
        let error = std::io::Error::last_os_error();
        Err(Failure::internal(format!("unshare: {error}")))
    }
}

export_component!(Faulty<LeavesNamespace>);
