//! Data of ports: awaited, read into the blackboard, and sent.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use behavior_tree::{Leaf, LeafContext, Status, Value};
use fault_manager::detection::NumberReader;

use super::{milliseconds, number};
use crate::clock::nanoseconds;
use crate::component::SafeDatum;
use crate::mission::reach::Reach;
use crate::port::{Receiver, Sender};
use crate::wake::Wake;

/// The newest datum of an output port, as a connection of its own shows it.
pub(in crate::mission) struct Watched {
    receiver: Receiver,
    /// None if only the arrival counts.
    reader: Option<NumberReader>,
    /// Time stamp in nanoseconds, and value, of the newest datum so far.
    newest: Option<(u64, f64)>,
}

impl Watched {
    pub(in crate::mission) fn new(receiver: Receiver, reader: Option<NumberReader>) -> Self {
        Self {
            receiver,
            reader,
            newest: None,
        }
    }

    /// Takes what has come; whether anything has.
    pub(super) fn look(&mut self) -> bool {
        let mut has_come = false;
        while let Some(datum) = self.receiver.receive() {
            let reader = self.reader.as_ref();
            let value = reader.map_or(f64::NAN, |reader| reader.read(datum.bytes()));
            self.newest = Some((datum.stamp_ns(), value));
            has_come = true;
        }
        has_come
    }

    /// Time stamp and value of the newest datum.
    pub(super) fn newest(&self) -> Option<(u64, f64)> {
        self.newest
    }
}

/// Waits for a datum.
pub(in crate::mission) struct WaitForData {
    watched: Watched,
    deadline: Duration,
}

impl WaitForData {
    pub(in crate::mission) fn new(watched: Watched) -> Self {
        Self {
            watched,
            deadline: Duration::ZERO,
        }
    }
}

impl Leaf for WaitForData {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        let has_come = self.watched.look();
        if context.begins {
            let timeout = milliseconds(context, "timeout_ms")?;
            self.deadline = context.now.saturating_add(timeout);
            return Ok(Status::Running);
        }
        Ok(match has_come {
            true => Status::Success,
            false if context.now < self.deadline => Status::Running,
            false => Status::Failure,
        })
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}

/// Puts a field on the blackboard.
pub(in crate::mission) struct ReadPort(pub(in crate::mission) Watched);

impl Leaf for ReadPort {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        self.0.look();
        let Some((stamp_ns, value)) = self.0.newest() else {
            return Ok(Status::Failure);
        };
        if context.input("max_age_ms").is_some() {
            let oldest = milliseconds(context, "max_age_ms")?;
            let age = context.now.saturating_sub(Duration::from_nanos(stamp_ns));
            if age > oldest {
                return Ok(Status::Failure);
            }
        }
        context.output("value", Value::Number(value))?;
        Ok(Status::Success)
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}

/// The way to an input port that trees alone send to. All nodes that write there share it.
pub(in crate::mission) struct Outlet {
    sender: Sender,
    /// What was sent last.
    last: Box<[u8]>,
    /// What wakes the receiver, if data do.
    wake: Option<Arc<Wake>>,
}

impl Outlet {
    pub(in crate::mission) fn new(sender: Sender, size: usize, wake: Option<Arc<Wake>>) -> Self {
        Self {
            sender,
            last: vec![0; size].into_boxed_slice(),
            wake,
        }
    }

    fn send(&mut self, now_ns: u64, incarnation: u32) {
        let content = &self.last;
        self.sender.send(now_ns, incarnation, |bytes| {
            bytes.copy_from_slice(content);
            true
        });
        if let Some(wake) = &self.wake {
            wake.wake();
        }
    }
}

/// Sends a datum to an input port: the field that is named has the value, time stamps are of now, the
/// rest is as it was sent last, at first zero.
pub(in crate::mission) struct WritePort {
    pub(in crate::mission) reach: Arc<Reach>,
    pub(in crate::mission) outlet: Arc<Mutex<Outlet>>,
    pub(in crate::mission) datum: SafeDatum,
}

impl Leaf for WritePort {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        self.datum.set(number(context, "value")?);
        let now_ns = nanoseconds(context.now);
        let incarnation = self.reach.incarnation(self.reach.tree()).max(1);
        let mut outlet = self.outlet.lock().unwrap_or_else(PoisonError::into_inner);
        self.datum.remember(&outlet.last);
        outlet.last.copy_from_slice(self.datum.at(now_ns));
        outlet.send(now_ns, incarnation);
        Ok(Status::Success)
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}
