//! Processes that a study starts for itself: none outlives it, none hangs for ever.

use std::io;
use std::time::Duration;

use rustix::process::{Signal, set_parent_process_death_signal};

/// Ends the calling process when the one that started it ends, however that does.
///
/// # Errors
/// If the system refuses that.
pub fn end_with_parent() -> io::Result<()> {
    Ok(set_parent_process_death_signal(Some(Signal::KILL))?)
}

/// Ends the calling process, with words and a core dump, if it has not ended in time.
///
/// # Errors
/// If the system refuses the thread that watches.
pub fn end_within(limit: Duration) -> io::Result<()> {
    let watching = std::thread::Builder::new().name("limit".to_owned());
    watching.spawn(move || {
        std::thread::sleep(limit);
        eprintln!("steadfast bench: a process was not done within {limit:?}");
        std::process::abort();
    })?;
    Ok(())
}
