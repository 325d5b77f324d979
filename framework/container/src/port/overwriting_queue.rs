//! A bounded queue between one writer and one reader that drops the oldest when it is full, and in
//! which neither side ever waits for the other.
//!
//! The queue holds indices of slots; the data stay where they are. The writer, finding the queue
//! full, takes the oldest index out itself, by the same compare-and-swap with which the reader
//! would have taken it, so exactly one of them gets it. (`rtrb` cannot drop the oldest; the queues
//! of crossbeam can, but there a writer waits for a reader that was interrupted half-way, for ever
//! if both run at real-time priority on one core.)
#![allow(unsafe_code)] // slots are reached by index ownership, which the compiler cannot see

use std::cell::UnsafeCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// The writing end.
pub(super) struct Writer<Item> {
    shared: Arc<Shared<Item>>,
    /// Indices that the reader gave back.
    free: rtrb::Consumer<u32>,
    /// The slot that belongs to the writer now.
    own: u32,
    written: u64,
}

/// The reading end.
pub(super) struct Reader<Item> {
    shared: Arc<Shared<Item>>,
    free: rtrb::Producer<u32>,
    /// The slot that belongs to the reader: the item it took last.
    own: Option<u32>,
}

struct Shared<Item> {
    slots: Box<[UnsafeCell<Item>]>,
    /// Ring of slot indices, its length a power of two: at least one place more than the capacity,
    /// so that the place the reader looks at is not the one that the writer fills.
    ring: Box<[AtomicU32]>,
    capacity: u64,
    /// Indices ever put in; written by the writer only.
    written: AtomicU64,
    /// Indices ever taken out, by either side.
    taken: AtomicU64,
}

// SAFETY: a slot is touched only by the side that owns its index. An index is owned by the writer
// (`own`), by the reader (`own`), by the ring, or by the free list, and passes between them by
// release stores and acquire loads.
unsafe impl<Item: Send> Sync for Shared<Item> {}

/// Makes a queue of `capacity` items, all slots filled with copies of `empty`.
pub(super) fn queue<Item: Clone>(capacity: usize, empty: &Item) -> (Writer<Item>, Reader<Item>) {
    // One slot for each place, one that the writer fills, one that the reader looks at.
    let slots = capacity + 2;
    let count = u32::try_from(slots).unwrap_or(u32::MAX);
    let shared = Arc::new(Shared {
        slots: (0..slots).map(|_| UnsafeCell::new(empty.clone())).collect(),
        ring: (0..(capacity + 1).next_power_of_two())
            .map(|_| AtomicU32::new(0))
            .collect(),
        capacity: capacity as u64,
        written: AtomicU64::new(0),
        taken: AtomicU64::new(0),
    });
    let (mut give_back, free) = rtrb::RingBuffer::new(slots);
    for index in 1..count {
        // Never full: it has a place for every slot.
        let _fits = give_back.push(index);
    }
    let writer = Writer {
        shared: Arc::clone(&shared),
        free,
        own: 0,
        written: 0,
    };
    let reader = Reader {
        shared,
        free: give_back,
        own: None,
    };
    (writer, reader)
}

impl<Item> Writer<Item> {
    /// The slot to fill next.
    pub(super) fn slot(&mut self) -> &mut Item {
        // SAFETY: the index is owned by the writer.
        unsafe { &mut *self.shared.slots[self.own as usize].get() }
    }

    /// Puts the filled slot into the queue; true if the oldest item was dropped for it.
    pub(super) fn publish(&mut self) -> bool {
        let evicted = self.evict_if_full();
        let shared = &*self.shared;
        shared
            .place(self.written)
            .store(self.own, Ordering::Relaxed);
        self.written += 1;
        shared.written.store(self.written, Ordering::Release);
        let next = evicted.or_else(|| self.free.pop().ok());
        // Never empty: of capacity + 2 slots the ring holds at most `capacity`, the reader one.
        self.own = next.unwrap_or(self.own);
        evicted.is_some()
    }

    fn evict_if_full(&self) -> Option<u32> {
        let shared = &*self.shared;
        let taken = shared.taken.load(Ordering::Acquire);
        if self.written - taken < shared.capacity {
            return None;
        }
        let oldest = shared.place(taken).load(Ordering::Relaxed);
        // If it fails the reader has just taken it, and there is room.
        shared
            .taken
            .compare_exchange(taken, taken + 1, Ordering::AcqRel, Ordering::Acquire)
            .is_ok()
            .then_some(oldest)
    }
}

impl<Item> Reader<Item> {
    /// Takes the oldest item; it stays readable until the next call.
    pub(super) fn take(&mut self) -> Option<&Item> {
        if let Some(own) = self.own.take() {
            // Never full: it has a place for every slot.
            let _fits = self.free.push(own);
        }
        let shared = &*self.shared;
        loop {
            let taken = shared.taken.load(Ordering::Acquire);
            if taken == shared.written.load(Ordering::Acquire) {
                return None;
            }
            let index = shared.place(taken).load(Ordering::Relaxed);
            // It fails only if the writer has dropped this item meanwhile: each round that is
            // lost is a new item that was written.
            let won = shared
                .taken
                .compare_exchange(taken, taken + 1, Ordering::AcqRel, Ordering::Acquire)
                .is_ok();
            if won {
                self.own = Some(index);
                // SAFETY: the index left the ring by our exchange: the reader owns it.
                return Some(unsafe { &*shared.slots[index as usize].get() });
            }
        }
    }
}

impl<Item> Shared<Item> {
    fn place(&self, position: u64) -> &AtomicU32 {
        // Positions wrap at 2^64, and the length is a power of two: cutting bits off is exact.
        &self.ring[position as usize & (self.ring.len() - 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Items under a flood that overwrites all the time: every one whole, in order, none twice.
    #[test]
    fn nothing_is_torn_repeated_or_reordered_under_a_flood() {
        const ITEMS: u64 = 200_000;
        for capacity in [1, 2, 7] {
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
}
