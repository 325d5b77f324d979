//! A bounded queue between one writer and one reader that drops the oldest when it is full, and in
//! which neither side ever waits for the other.
//!
//! The ring's cells hold numbers of slots; the data stay where they are. Putting an item in is one
//! exchange: the writer's filled slot against whatever slot the cell holds, which is either an old
//! item that nobody took (dropped by this very exchange) or one that the reader gave back. Taking
//! an item out is the same exchange the other way round, and succeeds only if the writer did not
//! come in between. So a slot belongs to the writer, to the reader, or to one cell, at any time.
//!
//! (`rtrb` cannot drop the oldest; the queues of crossbeam can, but there a writer waits for a
//! reader that was interrupted half-way, for ever if both run at real-time priority on one core.)
#![allow(unsafe_code)] // slots are reached by ownership of their numbers, unseen by the compiler

use std::cell::UnsafeCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crossbeam::utils::CachePadded;

/// The writing end.
pub struct Writer<Item> {
    shared: Arc<Shared<Item>>,
    /// The slot that belongs to the writer now.
    own: u64,
    /// Items ever written.
    written: u64,
    /// Where the next one goes: `written` modulo the number of places, without the division.
    place: usize,
}

/// The reading end.
pub struct Reader<Item> {
    shared: Arc<Shared<Item>>,
    /// The slot that belongs to the reader: the item it took last.
    own: u64,
    /// Position of the item to take next, counted from 0 at the queue's start.
    position: u64,
    /// Where it is: `position` modulo the number of places.
    place: usize,
}

struct Shared<Item> {
    /// Each on cache lines of its own: the two sides work on neighbours at the same time.
    slots: Box<[CachePadded<UnsafeCell<Item>>]>,
    /// One cell for each place; see [`Cell`].
    ring: Box<[AtomicU64]>,
}

/// What a cell holds: a slot, and the position of the item in it counted from 1, or 0 if the item
/// was taken.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Cell(u64);

/// Bits of a cell that hold the slot: a queue has fewer than 65,534 places. The other 48 count
/// items: at a million a second they last for nine years.
const SLOT_BITS: u32 = 16;

impl Cell {
    fn full(slot: u64, position: u64) -> Self {
        Self(((position + 1) << SLOT_BITS) | slot)
    }

    fn empty(slot: u64) -> Self {
        Self(slot)
    }

    fn slot(self) -> u64 {
        self.0 & ((1 << SLOT_BITS) - 1)
    }

    fn position(self) -> Option<u64> {
        (self.0 >> SLOT_BITS).checked_sub(1)
    }
}

/// Most places a queue can have.
pub const MOST_PLACES: usize = (1 << SLOT_BITS) - 2;

// SAFETY: a slot is touched only by the side that owns its number. Numbers change hands by the
// exchanges of `publish` and `take`, which release what was written and acquire what is read.
unsafe impl<Item: Send> Sync for Shared<Item> {}

/// Makes a queue of `capacity` items (1 to [`MOST_PLACES`]), all slots filled with copies of
/// `empty`.
pub fn queue<Item: Clone>(capacity: usize, empty: &Item) -> (Writer<Item>, Reader<Item>) {
    let capacity = capacity.clamp(1, MOST_PLACES);
    // One slot for each place, one that the writer fills, one that the reader looks at.
    let slots = 0..capacity + 2;
    let shared = Arc::new(Shared {
        slots: slots
            .map(|_| CachePadded::new(UnsafeCell::new(empty.clone())))
            .collect(),
        ring: (0..capacity as u64)
            .map(|slot| AtomicU64::new(Cell::empty(slot).0))
            .collect(),
    });
    let writer = Writer {
        shared: Arc::clone(&shared),
        own: capacity as u64,
        written: 0,
        place: 0,
    };
    let reader = Reader {
        shared,
        own: capacity as u64 + 1,
        position: 0,
        place: 0,
    };
    (writer, reader)
}

impl<Item> Writer<Item> {
    /// The slot to fill next.
    #[inline]
    pub fn slot(&mut self) -> &mut Item {
        // SAFETY: the number is the writer's own.
        unsafe { &mut *self.shared.slot(self.own) }
    }

    /// Puts the filled slot into the queue; true if the oldest item was dropped for it.
    #[inline]
    pub fn publish(&mut self) -> bool {
        let filled = Cell::full(self.own, self.written);
        let cell = &self.shared.ring[self.place];
        let before = Cell(cell.swap(filled.0, Ordering::AcqRel));
        self.written += 1;
        self.place = self.shared.after(self.place);
        self.own = before.slot();
        before.position().is_some()
    }
}

impl<Item> Reader<Item> {
    /// The item that was taken last.
    #[inline]
    pub fn last(&self) -> &Item {
        // SAFETY: the number is the reader's own.
        unsafe { &*self.shared.slot(self.own) }
    }

    /// Takes the oldest item; it stays readable until the next call.
    #[inline]
    pub fn take(&mut self) -> Option<&Item> {
        let capacity = self.shared.ring.len() as u64;
        loop {
            let cell = &self.shared.ring[self.place];
            let found = Cell(cell.load(Ordering::Acquire));
            let position = found.position()?;
            if position != self.position {
                // The writer went round: the oldest item that is left is one round behind this.
                self.position = position + 1 - capacity;
                // The remainder is below the number of places, which is a usize.
                self.place = (self.position % capacity) as usize;
                continue;
            }
            let given_back = Cell::empty(self.own);
            let taken =
                cell.compare_exchange(found.0, given_back.0, Ordering::AcqRel, Ordering::Relaxed);
            // It fails only if the writer came in between: each round that is lost is a new item.
            if taken.is_ok() {
                self.own = found.slot();
                self.position += 1;
                self.place = self.shared.after(self.place);
                return Some(self.last());
            }
        }
    }
}

impl<Item> Shared<Item> {
    #[inline]
    fn slot(&self, number: u64) -> *mut Item {
        // Numbers are below 2^16.
        self.slots[number as usize].get()
    }

    #[inline]
    fn after(&self, place: usize) -> usize {
        if place + 1 == self.ring.len() {
            0
        } else {
            place + 1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Items under a flood that overwrites all the time: every one whole, in order, none twice.
    #[test]
    fn nothing_is_torn_repeated_or_reordered_under_a_flood() {
        const ITEMS: u64 = 200_000;
        for capacity in [1, 2, 3, 7] {
            let (mut writer, mut reader) = queue(capacity, &[0u64; 16]);
            let flood = std::thread::spawn(move || {
                let mut dropped = 0u64;
                for number in 1..=ITEMS {
                    writer.slot().fill(number);
                    dropped += u64::from(writer.publish());
                }
                dropped
            });
            let (mut last, mut received) = (0, 0u64);
            while last < ITEMS {
                if let Some(item) = reader.take() {
                    assert!(item.iter().all(|word| *word == item[0]), "torn: {item:?}");
                    assert!(item[0] > last, "{} after {last}", item[0]);
                    last = item[0];
                    received += 1;
                }
            }
            let dropped = flood.join().expect("the writer does not panic");
            assert_eq!(received + dropped, ITEMS);
        }
    }

    /// Every interleaving of few puts and takes, one after the other, against a plain queue.
    #[test]
    fn every_order_of_puts_and_takes_is_that_of_a_plain_queue() {
        const STEPS: u32 = 12;
        for capacity in 1..=4 {
            for order in 0..1u32 << STEPS {
                let (mut writer, mut reader) = queue(capacity, &0u64);
                let mut plain = std::collections::VecDeque::new();
                for step in 0..STEPS {
                    if order >> step & 1 == 0 {
                        let number = u64::from(step) + 1;
                        *writer.slot() = number;
                        let dropped = plain.len() == capacity && plain.pop_front().is_some();
                        plain.push_back(number);
                        assert_eq!(writer.publish(), dropped, "{capacity} {order:b} {step}");
                    } else {
                        assert_eq!(
                            reader.take().copied(),
                            plain.pop_front(),
                            "{capacity} {order:b} {step}"
                        );
                    }
                }
            }
        }
    }
}
