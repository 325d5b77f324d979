//! A bounded queue between one sender and one receiver that refuses when it is full: events and
//! nonblocking calls must not vanish silently. Buffers travel forth and back, so nothing is
//! allocated after it was made.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use super::Datum;

/// The sending end.
pub struct MailSender {
    filled: rtrb::Producer<Datum>,
    empty: rtrb::Consumer<Datum>,
    accepted: Arc<AtomicU32>,
}

/// The receiving end.
pub struct MailReceiver {
    filled: rtrb::Consumer<Datum>,
    empty: rtrb::Producer<Datum>,
    /// What older incarnations of the sender have sent is not delivered. Incarnations count from 1:
    /// a message of 0 could not be read.
    accepted: Arc<AtomicU32>,
}

/// Makes a mailbox for `capacity` messages of `size` bytes.
pub fn mailbox(capacity: usize, size: usize) -> (MailSender, MailReceiver) {
    let (fill, filled) = rtrb::RingBuffer::new(capacity);
    let (mut give_back, empty) = rtrb::RingBuffer::new(capacity);
    for _ in 0..capacity {
        let message = Datum::empty(size);
        // Never full: it has a place for every message.
        let _fits = give_back.push(message);
    }
    let accepted = Arc::new(AtomicU32::new(1));
    (
        MailSender {
            filled: fill,
            empty,
            accepted: Arc::clone(&accepted),
        },
        MailReceiver {
            filled,
            empty: give_back,
            accepted,
        },
    )
}

/// What became of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sent {
    /// It is in the queue.
    Queued,
    /// The queue is full.
    Full,
    /// The content could not be read.
    Unreadable,
}

impl MailSender {
    /// From now on only what incarnation `incarnation` of the sender and later ones send is
    /// delivered.
    pub fn succeed(&self, incarnation: u32) {
        self.accepted.store(incarnation, Ordering::Relaxed);
    }

    /// Sends a message that `fill` writes.
    pub fn send(
        &mut self,
        stamp_ns: u64,
        incarnation: u32,
        fill: impl FnOnce(&mut [u8]) -> bool,
    ) -> Sent {
        let Ok(mut message) = self.empty.pop() else {
            return Sent::Full;
        };
        let readable = fill(message.bytes_mut());
        // Incarnations count from 1: 0 marks a message that the receiver throws away, because its
        // buffer can only travel back through the receiver.
        message.set_origin(stamp_ns, if readable { incarnation } else { 0 });
        // Never full: there are as many messages as places.
        let _fits = self.filled.push(message);
        if readable {
            Sent::Queued
        } else {
            Sent::Unreadable
        }
    }
}

impl MailReceiver {
    /// Takes the oldest message; to be handed back with [`Self::give_back`].
    pub fn take(&mut self) -> Option<Datum> {
        loop {
            let message = self.filled.pop().ok()?;
            if message.incarnation() >= self.accepted.load(Ordering::Relaxed) {
                return Some(message);
            }
            self.give_back(message);
        }
    }

    /// Hands a message's buffer back.
    pub fn give_back(&mut self, message: Datum) {
        // Never full: there are as many messages as places.
        let _fits = self.empty.push(message);
    }

    /// Throws away everything that has arrived.
    pub fn clear(&mut self) {
        while let Some(message) = self.take() {
            self.give_back(message);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_mailbox_refuses_and_keeps_the_order() {
        let (mut sender, mut receiver) = mailbox(2, 4);
        fn put(sender: &mut MailSender, value: u8) -> Sent {
            sender.send(0, 1, |bytes| {
                bytes[0] = value;
                value != 9
            })
        }
        let mut send = |value| put(&mut sender, value);
        assert_eq!(send(1), Sent::Queued);
        assert_eq!(send(2), Sent::Queued);
        assert_eq!(send(3), Sent::Full);
        let first = receiver.take().expect("queued");
        assert_eq!(first.bytes()[0], 1);
        receiver.give_back(first);
        assert_eq!(send(9), Sent::Unreadable);
        let second = receiver.take().expect("queued");
        assert_eq!(second.bytes()[0], 2);
        receiver.give_back(second);
        assert!(
            receiver.take().is_none(),
            "the unreadable one is not delivered"
        );
        assert_eq!(send(4), Sent::Queued);
        receiver.clear();
        assert!(receiver.take().is_none());
        assert_eq!(send(5), Sent::Queued);
        sender.succeed(2);
        assert!(
            receiver.take().is_none(),
            "the one that sent it is not there any more"
        );
    }
}
