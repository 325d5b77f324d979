//! Sends `SIGKILL` to the process that started its own; fails with what the system says to that.
//! Only for a process of its own: else it would hit whoever runs the container.
#![allow(unsafe_code)] // the misbehaviour itself

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct KillsParent;

impl Misbehaviour for KillsParent {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        // SAFETY: it has no arguments.
        let parent = unsafe { libc::getppid() };
        // SAFETY: a signal to a process; numbers only.
        let answer = unsafe { libc::kill(parent, libc::SIGKILL) };
        if answer == 0 {
            return Ok(());
        }
        let error = std::io::Error::last_os_error();
        Err(Failure::internal(format!("kill: {error}")))
    }
}

export_component!(Faulty<KillsParent>);
