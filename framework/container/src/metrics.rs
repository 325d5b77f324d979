//! Figures for Prometheus: counted from events and read from what the container knows, served over
//! HTTP in the OpenMetrics text format.

mod address;
mod server;
mod tally;
mod text;

use std::sync::{Arc, Mutex, PoisonError};

use crossbeam::channel::{Receiver, Sender, bounded};

use crate::control::RunningSystem;
use crate::event_log::Event;

pub use address::parse_address;
pub use server::MetricsServer;
pub use tally::Tally;

/// Events that may wait to be counted: as many as may wait for the event file.
const QUEUE: usize = 8192;

/// What is served: a system, and what has happened in it.
pub struct Metrics {
    system: RunningSystem,
    tally: Arc<Mutex<Tally>>,
}

impl Metrics {
    /// The figures of a system whose events `tally` has counted.
    pub fn new(system: RunningSystem, tally: Arc<Mutex<Tally>>) -> Self {
        Self { system, tally }
    }

    /// All of them, as OpenMetrics text.
    pub fn text(&self) -> String {
        let tally = self.tally.lock().unwrap_or_else(PoisonError::into_inner);
        text::of(&self.system.view(), &self.system.links(), &tally)
    }
}

/// Where events go, each with its time in nanoseconds of the container's clock.
pub type EventSender = Sender<(u64, Event)>;

/// A counter of events on a thread of its own, which ends when nobody sends any more: what is sent is
/// counted, and passed on to `listener`, if that has room.
///
/// # Errors
/// If the system refuses the thread.
pub fn count_events(listener: EventSender) -> std::io::Result<(EventSender, Arc<Mutex<Tally>>)> {
    let (sender, events) = bounded(QUEUE);
    let tally = Arc::new(Mutex::new(Tally::default()));
    let counted = Arc::clone(&tally);
    std::thread::Builder::new()
        .name("metrics-events".to_owned())
        .spawn(move || count_all(&events, &listener, &counted))?;
    Ok((sender, tally))
}

fn count_all(events: &Receiver<(u64, Event)>, listener: &EventSender, tally: &Mutex<Tally>) {
    for (t_ns, event) in events {
        let mut counted = tally.lock().unwrap_or_else(PoisonError::into_inner);
        counted.take(&event);
        drop(counted);
        // A person's view may lag; the count does not.
        let _lagging = listener.try_send((t_ns, event));
    }
}
