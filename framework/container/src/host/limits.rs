//! Bounds that a host sets itself before it loads a component, and cannot take back.

use std::io;

use rustix::process::{
    Resource, Rlimit, Signal, getppid, set_parent_process_death_signal, setpgid, setrlimit,
};

use system_model::rules::ProcessLimits;

use super::filter::refuse_system_calls;

/// Makes the host a process group of its own that dies with the container.
///
/// # Errors
/// If the system refuses.
pub(super) fn tie_to_container() -> io::Result<()> {
    set_parent_process_death_signal(Some(Signal::KILL))?;
    // Its parent may have died before: then the line to it is closed, and the host ends by that.
    let _parent = getppid();
    setpgid(None, None)?;
    rustix::thread::set_no_new_privs(true)?;
    Ok(())
}

/// Sets the bounds. A machine that knows no filters of system calls runs components without; the
/// README says so.
///
/// # Errors
/// If the system refuses one.
pub(super) fn bound(limits: &ProcessLimits) -> io::Result<()> {
    for (resource, limit) in [
        (Resource::Data, limits.memory_bytes),
        (Resource::Nofile, limits.open_files),
        (Resource::Cpu, limits.processor_time_s),
    ] {
        if let Some(limit) = limit {
            let both = Rlimit {
                current: Some(limit),
                maximum: Some(limit),
            };
            setrlimit(resource, both)?;
        }
    }
    if limits.filters_system_calls {
        let _without = refuse_system_calls();
    }
    Ok(())
}
