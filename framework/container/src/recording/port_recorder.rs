//! The two ends of a ring between a port and the thread that writes.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use rtrb::{Consumer, Producer, RingBuffer};

use crate::wake::Wake;

/// What a ring holds: half a second of a port at a hundred times the rate of the reference robot's
/// (5 kHz) with data of 84 bytes, ten times as long as the writing thread sleeps.
const RING_BYTES: usize = 256 << 10;

/// Data of any size that a ring holds at least: a camera's of more than a second.
const LEAST_DATA: usize = 16;

/// When a datum was seen and when it was written, before the datum itself.
const HEADER_BYTES: usize = 16;

/// In simulated time the writer of a full ring looks so often whether there is room again.
const ROOM_PERIOD: Duration = Duration::from_micros(50);

/// The end at a port. Wait-free, unless time is simulated.
#[derive(Debug)]
pub struct PortRecorder {
    ring: Producer<u8>,
    entry_bytes: usize,
    dropped: Arc<AtomicU64>,
    /// The thread at the other end, where time waits for it.
    waits_for: Option<Arc<Wake>>,
}

/// The end of an event port, where content is in the sender's memory only.
#[derive(Debug)]
pub struct EventRecorder {
    /// The content of the event at hand.
    pub scratch: Box<[u8]>,
    /// Where it goes.
    pub port: PortRecorder,
}

/// The end of the thread that writes.
#[derive(Debug)]
pub(super) struct Track {
    ring: Consumer<u8>,
    entry_bytes: usize,
    dropped: Arc<AtomicU64>,
    /// When the next datum was seen, if one is there.
    next_ns: Option<u64>,
}

/// One datum of a ring.
#[derive(Debug, Clone, Copy)]
pub(super) struct Taken<'ring> {
    pub(super) seen_ns: u64,
    pub(super) written_ns: u64,
    pub(super) bytes: &'ring [u8],
}

/// A ring for data of `size` bytes. With `waits_for` its writer waits for room instead of dropping.
pub(super) fn ring(size: usize, waits_for: Option<Arc<Wake>>) -> (PortRecorder, Track) {
    let entry_bytes = HEADER_BYTES + size;
    // A multiple of an entry, so that none is ever in two pieces.
    let entries = (RING_BYTES / entry_bytes).max(LEAST_DATA);
    let (producer, consumer) = RingBuffer::new(entries * entry_bytes);
    let dropped = Arc::new(AtomicU64::new(0));
    let recorder = PortRecorder {
        ring: producer,
        entry_bytes,
        dropped: Arc::clone(&dropped),
        waits_for,
    };
    let track = Track {
        ring: consumer,
        entry_bytes,
        dropped,
        next_ns: None,
    };
    (recorder, track)
}

impl PortRecorder {
    /// Puts down a datum that was seen and written at these times of the container's clock. Its size
    /// is that of the port.
    #[inline]
    pub fn record(&mut self, seen_ns: u64, written_ns: u64, datum: &[u8]) {
        debug_assert_eq!(datum.len() + HEADER_BYTES, self.entry_bytes);
        if self.ring.slots() < self.entry_bytes && !self.wait_for_room() {
            // One writer at a time: a plain store, not a locked one.
            let dropped = self.dropped.load(Ordering::Relaxed);
            self.dropped.store(dropped + 1, Ordering::Relaxed);
            return;
        }
        // There is room for all three.
        for part in [&seen_ns.to_ne_bytes()[..], &written_ns.to_ne_bytes(), datum] {
            let _there_is_room = self.ring.push_entire_slice(part);
        }
    }

    /// Waits where time does; whether there is room now.
    #[cold]
    fn wait_for_room(&self) -> bool {
        let Some(reader) = &self.waits_for else {
            return false;
        };
        // The other end is gone when nobody writes any more.
        while !self.ring.is_abandoned() {
            reader.wake();
            std::thread::sleep(ROOM_PERIOD);
            if self.ring.slots() >= self.entry_bytes {
                return true;
            }
        }
        false
    }
}

impl Track {
    /// When the oldest datum was seen that is there.
    pub(super) fn next_ns(&mut self) -> Option<u64> {
        if self.next_ns.is_none() && self.ring.slots() >= self.entry_bytes {
            let mut seen_ns = [0; 8];
            let header = self.ring.read_chunk(self.entry_bytes).ok()?;
            seen_ns.copy_from_slice(header.as_slices().0.get(..8)?);
            self.next_ns = Some(u64::from_ne_bytes(seen_ns));
        }
        self.next_ns
    }

    /// Takes the oldest datum to `with`, if one is there.
    pub(super) fn take(&mut self, with: impl FnOnce(Taken<'_>)) {
        self.next_ns = None;
        let Ok(chunk) = self.ring.read_chunk(self.entry_bytes) else {
            return;
        };
        let (entry, _never_in_two_pieces) = chunk.as_slices();
        if let Some((header, bytes)) = entry.split_at_checked(HEADER_BYTES) {
            let (mut seen_ns, mut written_ns) = ([0; 8], [0; 8]);
            seen_ns.copy_from_slice(&header[..8]);
            written_ns.copy_from_slice(&header[8..]);
            with(Taken {
                seen_ns: u64::from_ne_bytes(seen_ns),
                written_ns: u64::from_ne_bytes(written_ns),
                bytes,
            });
        }
        chunk.commit_all();
    }

    /// How full it is, in percent.
    pub(super) fn fill_percent(&self) -> usize {
        100 * self.ring.slots() / self.ring.buffer().capacity()
    }

    /// Whether there is no room for another datum.
    pub(super) fn is_full(&self) -> bool {
        self.ring.slots() + self.entry_bytes > self.ring.buffer().capacity()
    }

    /// How many data were dropped so far.
    pub(super) fn dropped(&self) -> &Arc<AtomicU64> {
        &self.dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(track: &mut Track) -> Option<(u64, u64, Vec<u8>)> {
        track.next_ns()?;
        let mut taken = None;
        track.take(|it| taken = Some((it.seen_ns, it.written_ns, it.bytes.to_vec())));
        taken
    }

    #[test]
    fn data_come_whole_and_in_order_and_what_does_not_fit_is_counted() {
        for size in [0usize, 1, 24, 57_600, 1 << 20] {
            let (mut recorder, mut track) = ring(size, None);
            let entries = (RING_BYTES / (HEADER_BYTES + size)).max(LEAST_DATA) as u64;
            assert_eq!(taken(&mut track), None);
            // Begins somewhere in the middle, so that the ring's end is passed.
            for round in 0..3 {
                for number in 0..entries + 5 {
                    recorder.record(round + number, number, &vec![number as u8; size]);
                }
                assert!(track.is_full());
                for number in 0..entries {
                    let expected = (round + number, number, vec![number as u8; size]);
                    assert_eq!(taken(&mut track), Some(expected), "{size}");
                }
                assert_eq!(taken(&mut track), None);
            }
            assert_eq!(track.dropped().load(Ordering::Relaxed), 15);
        }
    }

    #[test]
    fn in_simulated_time_nothing_is_lost_and_nobody_waits_for_the_dead() {
        let reader = Arc::new(Wake::default());
        let (mut recorder, mut track) = ring(1 << 20, Some(Arc::clone(&reader)));
        let writer = std::thread::spawn(move || {
            for number in 0..40 {
                recorder.record(number, number, &vec![0; 1 << 20]);
            }
            recorder
        });
        let mut numbers = Vec::new();
        while numbers.len() < 40 {
            reader.take();
            match taken(&mut track) {
                Some((seen_ns, _, _)) => numbers.push(seen_ns),
                None => reader.sleep(Duration::from_millis(10)),
            }
        }
        assert_eq!(numbers, (0..40).collect::<Vec<_>>());
        let mut recorder = writer.join().unwrap();
        drop(track);
        for number in 0..40 {
            recorder.record(number, number, &vec![0; 1 << 20]);
        }
        assert_eq!(recorder.dropped.load(Ordering::Relaxed), 24);
    }
}
