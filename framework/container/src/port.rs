//! Connections between ports: one buffer for each, so that fan-out is a loop in the writer and
//! neither side ever waits for the other.

mod datum;
mod mailbox;
pub mod overwriting_queue;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use system_model::specification::QueuePolicy;

pub use datum::Datum;
pub use mailbox::{MailReceiver, MailSender, Sent, mailbox};
use overwriting_queue::{Reader, Writer};

/// The writing end of a connection.
pub struct Sender {
    buffer: SendBuffer,
    counts: Arc<Counts>,
}

/// The reading end of a connection.
pub struct Receiver {
    buffer: ReceiveBuffer,
    counts: Arc<Counts>,
}

#[derive(Debug, Default)]
struct Counts {
    /// By the writer, because the queue was full.
    overwritten: AtomicU64,
    /// By the reader, because its stack was full.
    forgotten: AtomicU64,
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
    let counts = Arc::new(Counts::default());
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
                pile: Pile {
                    slots: vec![empty; queue_size],
                    filled: 0,
                },
            };
            (SendBuffer::Queue(writer), receive)
        }
    };
    let sender = Sender {
        buffer: send,
        counts: Arc::clone(&counts),
    };
    let receiver = Receiver {
        buffer: receive,
        counts,
    };
    (sender, receiver)
}

impl Sender {
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
        match &mut self.buffer {
            SendBuffer::Last(input) => {
                input.publish();
            }
            SendBuffer::Queue(writer) => {
                if writer.publish() {
                    increase(&self.counts.overwritten);
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
        match &mut self.buffer {
            ReceiveBuffer::Last(output) => {
                if output.update() {
                    Some(output.output_buffer())
                } else {
                    None
                }
            }
            ReceiveBuffer::Fifo(reader) => reader.take(),
            ReceiveBuffer::Lifo { arrivals, pile } => {
                while let Some(datum) = arrivals.take() {
                    if pile.push(datum) {
                        increase(&self.counts.forgotten);
                    }
                }
                pile.pop()
            }
        }
    }

    /// Drops everything that has arrived.
    pub fn clear(&mut self) {
        while self.receive().is_some() {}
    }

    /// Data dropped because the reader did not keep up.
    pub fn dropped(&self) -> u64 {
        let counts = &self.counts;
        counts.overwritten.load(Ordering::Relaxed) + counts.forgotten.load(Ordering::Relaxed)
    }
}

/// What a LIFO input holds, newest on top. Its buffers are made once.
struct Pile {
    slots: Vec<Datum>,
    filled: usize,
}

impl Pile {
    /// Puts a copy on top; true if the oldest had to go for it.
    fn push(&mut self, datum: &Datum) -> bool {
        let full = self.filled == self.slots.len();
        if full {
            self.slots.rotate_left(1);
        } else {
            self.filled += 1;
        }
        let top = &mut self.slots[self.filled - 1];
        top.copy_from(datum);
        full
    }

    fn pop(&mut self) -> Option<&Datum> {
        self.filled = self.filled.checked_sub(1)?;
        self.slots.get(self.filled)
    }
}

/// Adds one to a counter that has a single writer at a time: a plain store, not a locked one.
fn increase(counter: &AtomicU64) {
    counter.store(counter.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(sender: &mut Sender, value: u8) {
        assert!(sender.send(u64::from(value), 1, |bytes| {
            bytes.fill(value);
            true
        }));
    }

    fn all(receiver: &mut Receiver) -> Vec<u8> {
        let mut found = Vec::new();
        while let Some(datum) = receiver.receive() {
            found.push(datum.bytes()[0]);
        }
        found
    }

    #[test]
    fn each_policy_keeps_what_it_should() {
        type Case = (QueuePolicy, usize, &'static [u8], &'static [u8], u64);
        let cases: [Case; 5] = [
            (QueuePolicy::Last, 1, &[1, 2, 3], &[3], 0),
            (QueuePolicy::Fifo, 3, &[1, 2], &[1, 2], 0),
            (QueuePolicy::Fifo, 3, &[1, 2, 3, 4, 5], &[3, 4, 5], 2),
            (QueuePolicy::Lifo, 3, &[1, 2, 3], &[3, 2, 1], 0),
            (QueuePolicy::Lifo, 2, &[1, 2, 3, 4], &[4, 3], 2),
        ];
        for (policy, size, sent, expected, dropped) in cases {
            let (mut sender, mut receiver) = connection(policy, size, 8);
            assert!(receiver.receive().is_none(), "{policy:?} starts empty");
            for value in sent {
                put(&mut sender, *value);
            }
            assert_eq!(all(&mut receiver), expected, "{policy:?} of {size}");
            assert_eq!(receiver.dropped(), dropped, "{policy:?} of {size}");
        }
    }

    #[test]
    fn a_fill_that_fails_sends_nothing() {
        for policy in [QueuePolicy::Last, QueuePolicy::Fifo, QueuePolicy::Lifo] {
            let (mut sender, mut receiver) = connection(policy, 4, 8);
            assert!(!sender.send(0, 1, |_bytes| false));
            assert!(receiver.receive().is_none());
        }
    }

    #[test]
    fn clearing_forgets_what_had_arrived() {
        for policy in [QueuePolicy::Last, QueuePolicy::Fifo, QueuePolicy::Lifo] {
            let (mut sender, mut receiver) = connection(policy, 4, 8);
            put(&mut sender, 1);
            receiver.clear();
            assert!(receiver.receive().is_none());
            put(&mut sender, 2);
            assert_eq!(all(&mut receiver), [2]);
        }
    }
}
