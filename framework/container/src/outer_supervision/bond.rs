//! What ties a child of the parent to it: it dies with it, and has one line to it.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::os::fd::AsFd as _;
use std::os::unix::net::UnixStream;

use rustix::process::{Pid, Signal, getppid, set_parent_process_death_signal};

/// Makes this process die when `parent` does, however it does.
///
/// # Errors
/// If the parent is gone already.
pub fn die_with_parent(parent: i32) -> io::Result<()> {
    set_parent_process_death_signal(Some(Signal::KILL))?;
    // The signal comes for deaths from now on; who died before is not the parent any more.
    if getppid().map(Pid::as_raw_pid) == Some(parent) {
        Ok(())
    } else {
        let message = format!("process {parent} is not the parent of this one");
        Err(io::Error::new(ErrorKind::NotFound, message))
    }
}

/// Takes the line to the parent from the standard input, where nobody finds it any more.
///
/// # Errors
/// If the system refuses.
pub fn take_line() -> io::Result<UnixStream> {
    let line = io::stdin().as_fd().try_clone_to_owned()?;
    rustix::stdio::dup2_stdin(File::open("/dev/null")?)?;
    Ok(line.into())
}
