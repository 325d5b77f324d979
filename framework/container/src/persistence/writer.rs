//! The thread that writes. Whatever the disk does, only this thread waits for it.

use std::io;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, bounded};
use rustix::process::setpriority_process;
use rustix::thread::gettid;

use super::handover::CopyReceiver;
use super::record::{LibraryIdentity, Record};
use super::slots::Slots;
use crate::component::Environment;
use crate::event_log::Event;

/// How often the newest copies are written. A tenth of a second of work is lost with the container;
/// written much more often, a flash card would do nothing else (a sync takes it some milliseconds).
const WRITE_PERIOD: Duration = Duration::from_millis(100);

/// Below everything else that is not idle, where the system is busy; but not starved.
const NICENESS: i32 = 10;

/// The copies of one component, and where they belong.
#[derive(Debug)]
pub struct Kept {
    /// Where they come from.
    pub receiver: CopyReceiver,
    /// Its files.
    pub slots: Slots,
    /// What is written; origin and number are those of the last one.
    pub record: Record,
    /// The libraries that can play the component's part, by variant.
    pub libraries: Vec<LibraryIdentity>,
    /// Whether the last writing failed.
    pub failing: bool,
}

/// The thread, once started. It ends when this is dropped.
#[derive(Debug)]
pub struct Writer {
    running: Sender<()>,
    ended: Receiver<()>,
}

impl Writer {
    /// Starts it.
    ///
    /// # Errors
    /// If the system refuses a thread.
    pub fn start(mut kept: Vec<Kept>, environment: Arc<Environment>) -> io::Result<Self> {
        let (running, asked) = bounded::<()>(0);
        let (ending, ended) = bounded::<()>(0);
        std::thread::Builder::new()
            .name("persistence".to_owned())
            .spawn(move || {
                let _until_it_ends = ending;
                // Refused nowhere that is known; it would only disturb others more.
                let _less_polite = setpriority_process(Some(gettid()), NICENESS);
                while asked.recv_timeout(WRITE_PERIOD) == Err(RecvTimeoutError::Timeout) {
                    for one in &mut kept {
                        one.write_newest(&environment);
                    }
                }
            })?;
        Ok(Self { running, ended })
    }

    /// Ends it; false if the disk keeps it for longer than `limit`.
    pub fn stop(self, limit: Duration) -> bool {
        drop(self.running);
        self.ended.recv_timeout(limit) == Err(RecvTimeoutError::Disconnected)
    }
}

impl Kept {
    fn write_newest(&mut self, environment: &Environment) {
        let Some(copy) = self.receiver.take() else {
            return;
        };
        let age_ns = environment.clock.now_ns().saturating_sub(copy.taken_ns);
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        self.record.taken = now
            .unwrap_or_default()
            .saturating_sub(Duration::from_nanos(age_ns));
        self.record.sequence = copy.sequence;
        self.record.incarnation = copy.incarnation;
        self.record.memory.clone_from(&copy.memory);
        if let Some(library) = self.libraries.get(copy.variant) {
            self.record.origin.library.clone_from(library);
        }
        let result = self.slots.write(&mut self.record);
        let component = &self.record.origin.component;
        let message = match &result {
            Err(error) if !self.failing => format!(
                "the state of '{component}' cannot be written, it would be lost with the container: \
                 {error}"
            ),
            Ok(()) if self.failing => format!("the state of '{component}' is written again"),
            _ => String::new(),
        };
        self.failing = result.is_err();
        if !message.is_empty() {
            let now_ns = environment.clock.now_ns();
            environment.events.record(now_ns, Event::Notice { message });
        }
    }
}
