//! Connections between ports: one buffer for each, so that fan-out is a loop in the writer and
//! neither side ever waits for the other.

mod datum;
mod identity;
mod mailbox;
pub mod overwriting_queue;
mod pile;

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use system_model::specification::QueuePolicy;

use crossbeam::utils::CachePadded;
pub use datum::Datum;
pub use identity::ConnectionId;
pub use mailbox::{MailReceiver, MailSender, Sent, mailbox};
use overwriting_queue::{Reader, Writer};
use pile::Pile;

/// The writing end of a connection.
pub struct Sender {
    buffer: SendBuffer,
    shared: Arc<Shared>,
    /// Where the time of the newest datum is left, if somebody wants to know its age.
    newest: Option<Arc<Newest>>,
}

/// The reading end of a connection.
pub struct Receiver {
    buffer: ReceiveBuffer,
    shared: Arc<Shared>,
    /// The datum taken last is to be taken once more: who had it in work died of something.
    again: bool,
    /// Incarnations that died with the datum taken last in work.
    deaths: u32,
}

/// When the newest datum of a connection was written, in nanoseconds of the container's clock; 0
/// before the first one. On a cache line of its own: it is written with every datum.
pub type Newest = CachePadded<AtomicU64>;

/// A datum is given to a second incarnation when the first one died of it or of something else;
/// after that it is the datum.
pub const MOST_DEATHS: u32 = 2;

/// What both ends share.
#[derive(Debug, Default)]
struct Shared {
    /// Dropped by the writer, because the queue was full.
    overwritten: AtomicU64,
    /// Dropped by the reader, because its stack was full.
    forgotten: AtomicU64,
    /// What older incarnations of the writer have sent is not delivered any more. Read with every
    /// datum, so not on the line of the counters, which the other side may be writing.
    accepted: CachePadded<AtomicU32>,
}

/// What becomes of a datum whose reader died.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leftover {
    /// The next incarnation gets it again, unless there is a newer one by then.
    Again,
    /// It is set aside: a second incarnation has died of it.
    SetAside {
        /// When it was written.
        stamp_ns: u64,
    },
}

enum SendBuffer {
    Last(triple_buffer::Input<Datum>),
    Queue(Writer<Datum>),
}

enum ReceiveBuffer {
    Last(triple_buffer::Output<Datum>),
    Fifo(Reader<Datum>),
    Lifo { arrivals: Reader<Datum>, pile: Pile },
}

/// Makes a connection for data of `size` bytes that keeps as much as the policy says.
pub fn connection(policy: QueuePolicy, queue_size: usize, size: usize) -> (Sender, Receiver) {
    let empty = Datum::empty(size);
    let queue_size = queue_size.max(1);
    let shared = Arc::new(Shared::default());
    let (send, receive) = match policy {
        QueuePolicy::Last => {
            let (input, output) = triple_buffer::triple_buffer(&empty);
            (SendBuffer::Last(input), ReceiveBuffer::Last(output))
        }
        QueuePolicy::Fifo => {
            let (writer, reader) = overwriting_queue::queue(queue_size, &empty);
            (SendBuffer::Queue(writer), ReceiveBuffer::Fifo(reader))
        }
        QueuePolicy::Lifo => {
            let (writer, arrivals) = overwriting_queue::queue(queue_size, &empty);
            let receive = ReceiveBuffer::Lifo {
                arrivals,
                pile: Pile::new(queue_size, &empty),
            };
            (SendBuffer::Queue(writer), receive)
        }
    };
    let sender = Sender {
        buffer: send,
        shared: Arc::clone(&shared),
        newest: None,
    };
    let receiver = Receiver {
        buffer: receive,
        shared,
        again: false,
        deaths: 0,
    };
    (sender, receiver)
}

impl Sender {
    /// From now on only what incarnation `incarnation` of the writer and later ones send is
    /// delivered; what older ones have left in the queue is not.
    pub fn succeed(&self, incarnation: u32) {
        self.shared.accepted.store(incarnation, Ordering::Relaxed);
    }

    /// Where the time of the newest datum can be read from now on.
    pub fn watch(&mut self) -> Arc<Newest> {
        Arc::clone(self.newest.get_or_insert_default())
    }

    /// Sends a datum that `fill` writes; nothing is sent if it answers false. Never waits.
    #[inline]
    pub fn send(
        &mut self,
        stamp_ns: u64,
        incarnation: u32,
        fill: impl FnOnce(&mut [u8]) -> bool,
    ) -> bool {
        let datum = match &mut self.buffer {
            SendBuffer::Last(input) => input.input_buffer_mut(),
            SendBuffer::Queue(writer) => writer.slot(),
        };
        if !fill(datum.bytes_mut()) {
            return false;
        }
        datum.set_origin(stamp_ns, incarnation);
        if let Some(newest) = &self.newest {
            newest.store(stamp_ns.max(1), Ordering::Relaxed);
        }
        match &mut self.buffer {
            SendBuffer::Last(input) => {
                input.publish();
            }
            SendBuffer::Queue(writer) => {
                if writer.publish() {
                    increase(&self.shared.overwritten);
                }
            }
        }
        true
    }
}

impl Receiver {
    /// The next datum by the connection's policy, if one has arrived since the last was taken.
    #[inline]
    pub fn receive(&mut self) -> Option<&Datum> {
        self.advance().then(|| self.current())
    }

    /// Whether data wait in a queue, each to be read once.
    pub fn has_queue(&self) -> bool {
        !matches!(self.buffer, ReceiveBuffer::Last(_))
    }

    /// What becomes of the datum that was taken last, now that the incarnation that took it died.
    pub fn leave(&mut self) -> Leftover {
        self.deaths += 1;
        if self.deaths < MOST_DEATHS {
            self.again = true;
            return Leftover::Again;
        }
        self.again = false;
        Leftover::SetAside {
            stamp_ns: self.current().stamp_ns(),
        }
    }

    /// Goes on to the next datum that may be delivered; false if there is none.
    #[inline]
    fn advance(&mut self) -> bool {
        loop {
            let (fresh, found) = self.take_any();
            if !found {
                return false;
            }
            if fresh {
                self.deaths = 0;
            }
            let accepted = self.shared.accepted.load(Ordering::Relaxed);
            if self.current().incarnation() >= accepted {
                return true;
            }
        }
    }

    /// Whether a datum was taken that had not been taken before, and whether any was.
    #[inline]
    fn take_any(&mut self) -> (bool, bool) {
        let again = std::mem::take(&mut self.again);
        match &mut self.buffer {
            ReceiveBuffer::Last(output) => {
                let fresh = output.update();
                (fresh, fresh || again)
            }
            _ if again => (false, true),
            ReceiveBuffer::Fifo(reader) => {
                let found = reader.take().is_some();
                (found, found)
            }
            ReceiveBuffer::Lifo { arrivals, pile } => {
                while let Some(datum) = arrivals.take() {
                    if pile.push(datum) {
                        increase(&self.shared.forgotten);
                    }
                }
                let found = pile.pop();
                (found, found)
            }
        }
    }

    /// The datum that was taken last.
    #[inline]
    fn current(&self) -> &Datum {
        match &self.buffer {
            ReceiveBuffer::Last(output) => output.output_buffer(),
            ReceiveBuffer::Fifo(reader) => reader.last(),
            ReceiveBuffer::Lifo { pile, .. } => pile.taken(),
        }
    }

    /// Drops everything that has arrived.
    pub fn clear(&mut self) {
        while self.receive().is_some() {}
    }

    /// Data dropped because the reader did not keep up.
    pub fn dropped(&self) -> u64 {
        self.drops().count()
    }

    /// The same for who is not the reader.
    pub fn drops(&self) -> Drops {
        Drops(Arc::clone(&self.shared))
    }
}

/// How many data of a connection were dropped, readable from any thread at any time.
#[derive(Debug, Clone)]
pub struct Drops(Arc<Shared>);

impl Drops {
    /// So many, because the reader did not keep up.
    pub fn count(&self) -> u64 {
        let shared = &self.0;
        shared.overwritten.load(Ordering::Relaxed) + shared.forgotten.load(Ordering::Relaxed)
    }
}

/// Adds one to a counter that has a single writer at a time: a plain store, not a locked one.
fn increase(counter: &AtomicU64) {
    counter.store(counter.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
}

#[cfg(test)]
mod tests;
