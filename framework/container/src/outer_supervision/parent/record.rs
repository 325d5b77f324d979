//! What a parent says and writes down itself.

use std::io::{self, Write as _};
use std::path::Path;
use std::time::Duration;

use crate::clock::nanoseconds;
use crate::event_log::{Event, EventLog};

/// Says something to whoever looks on.
pub(super) fn say(text: &str) {
    // If nobody reads it, the events and the exit code still tell.
    let _unread = writeln!(io::stderr(), "steadfast: {text}");
}

/// What is held in its safe state, in words.
pub(super) fn held(devices: &[&str]) -> String {
    match devices {
        [] => String::new(),
        devices => format!(", safe state on {}", devices.join(", ")),
    }
}

/// The last event of a run whose container will not be restarted; there is nobody else to write it.
pub(super) fn given_up(
    events: &Path,
    run_time: Duration,
    restarts: u32,
    seen: String,
    judged: String,
) -> io::Result<()> {
    let (log, writer) = EventLog::resume(Some(events), false, None)?;
    let event = Event::ContainerGivenUp {
        restarts,
        seen,
        judged,
    };
    log.record(nanoseconds(run_time), event);
    log.finish();
    writer.close()
}
