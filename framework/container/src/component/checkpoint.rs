//! Checkpoints: copies of the memory that a component registered as critical (`critical`, Ahn et
//! al. 2012, section 3.4.1), taken between callbacks, by which a successor is restored.
//!
//! A copy is certified only if all outputs of its cycle passed their checks, and the last few are
//! kept, so that the state which is restored is older than the first symptom: a contaminated state
//! is not brought back.

use std::time::Duration;

use crc32c::crc32c;

use super::inheritance::Inheritance;
use super::services::Services;
use crate::persistence::CopySender;

/// Copies that are kept. The oldest is two periods older than the newest: enough for a fault that
/// is found some cycles after it began.
const KEPT: usize = 3;

/// Cycles of the machine's clock, and those that a successor does again, come as unevenly as this
/// part of a period: a component with a backup in every cycle shall have it in every cycle.
const UNEVENNESS: u64 = 8;

/// The copies of one component.
#[derive(Debug)]
pub struct Checkpoints {
    period_ns: u64,
    due_ns: u64,
    /// Number of the copy that was taken last, counted from 1.
    sequence: u64,
    copies: [Copy; KEPT],
    /// Where copies go that outlive the container.
    pub(super) disk: Option<CopySender>,
    /// What a run that died has left, until it is restored.
    pub(super) inheritance: Option<Inheritance>,
}

#[derive(Debug, Default)]
struct Copy {
    /// 0 while it is being written, or before the first time.
    sequence: u64,
    taken_ns: u64,
    /// By the polynomial of iSCSI, for which processors have an instruction: a table would take
    /// longer than all the rest of a takeover.
    checksum: u32,
    bytes: Vec<u8>,
}

/// A copy that may be restored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Certified<'checkpoints> {
    /// Its number.
    pub sequence: u64,
    /// When it was taken, in nanoseconds of the container's clock.
    pub taken_ns: u64,
    /// The memory.
    pub bytes: &'checkpoints [u8],
}

impl Checkpoints {
    /// None taken yet; one is due in every period.
    pub fn new(period: Duration) -> Self {
        Self {
            period_ns: u64::try_from(period.as_nanos()).unwrap_or(u64::MAX),
            due_ns: 0,
            sequence: 0,
            copies: Default::default(),
            disk: None,
            inheritance: None,
        }
    }

    /// Copies the registered memory of an instance of the library `variant` if the period is over and
    /// the cycle's outputs were good.
    #[inline]
    pub(super) fn take_if_due(&mut self, services: &Services, variant: usize) {
        let now_ns = services.cycle_ns();
        if now_ns >= self.due_ns && !services.is_contaminated() {
            self.take(now_ns, services, variant);
        }
    }

    fn take(&mut self, now_ns: u64, services: &Services, variant: usize) {
        let Some(memory) = services.critical_memory() else {
            return;
        };
        self.due_ns = now_ns + self.period_ns - self.period_ns / UNEVENNESS;
        let next = self.sequence + 1;
        let copy = &mut self.copies[(next % KEPT as u64) as usize];
        copy.sequence = 0;
        // Once, when the memory was registered: its size does not change.
        copy.bytes.resize(memory.size(), 0);
        if !memory.copy_to(&mut copy.bytes) {
            return;
        }
        copy.checksum = crc32c(&copy.bytes);
        copy.taken_ns = now_ns;
        copy.sequence = next;
        self.sequence = next;
        if let Some(disk) = &mut self.disk {
            disk.send(variant, services.incarnation(), next, now_ns, &copy.bytes);
        }
    }

    /// A copy that is older than all that are taken here, and has this number.
    pub(super) fn inherit(&mut self, sequence: u64, bytes: Vec<u8>) {
        self.sequence = sequence;
        self.copies[(sequence % KEPT as u64) as usize] = Copy {
            sequence,
            taken_ns: 0,
            checksum: crc32c(&bytes),
            bytes,
        };
    }

    /// The copy of this number was restored: on the disk, too, it is the newest now, because those
    /// that were taken after it may be contaminated.
    pub(super) fn send_again(&mut self, sequence: u64, variant: usize, incarnation: u32) {
        let copy = &self.copies[(sequence % KEPT as u64) as usize];
        if let Some(disk) = &mut self.disk {
            disk.send(variant, incarnation, sequence, copy.taken_ns, &copy.bytes);
        }
    }

    /// The newest whole copy that was taken before `before_ns`; how many were found broken.
    pub fn newest_before(&self, before_ns: u64) -> (Option<Certified<'_>>, usize) {
        let mut broken = 0;
        let mut below = u64::MAX;
        loop {
            let whole = self.copies.iter().filter(|copy| {
                copy.sequence > 0 && copy.sequence < below && copy.taken_ns < before_ns
            });
            let Some(copy) = whole.max_by_key(|copy| copy.sequence) else {
                return (None, broken);
            };
            if crc32c(&copy.bytes) == copy.checksum {
                let certified = Certified {
                    sequence: copy.sequence,
                    taken_ns: copy.taken_ns,
                    bytes: &copy.bytes,
                };
                return (Some(certified), broken);
            }
            broken += 1;
            below = copy.sequence;
        }
    }

    /// Turns a bit of the newest copy round (fault injection).
    pub fn corrupt(&mut self) {
        let newest = &mut self.copies[(self.sequence % KEPT as u64) as usize];
        if let Some(byte) = newest.bytes.first_mut() {
            *byte ^= 1;
        }
    }

    #[cfg(test)]
    fn keep(&mut self, taken_ns: u64, content: &[u8]) {
        self.sequence += 1;
        self.copies[(self.sequence % KEPT as u64) as usize] = Copy {
            sequence: self.sequence,
            taken_ns,
            checksum: crc32c(content),
            bytes: content.to_vec(),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::persistence::handover;

    #[test]
    fn a_copy_that_was_restored_is_the_newest_on_the_disk() {
        let mut checkpoints = Checkpoints::new(Duration::from_millis(1));
        let (sender, mut receiver) = handover(1);
        checkpoints.disk = Some(sender);
        for taken_ns in [10, 20, 30] {
            checkpoints.keep(taken_ns, &[0]);
        }
        checkpoints.send_again(2, 1, 7);
        let sent = receiver.take().expect("it was sent");
        assert_eq!((sent.sequence, sent.taken_ns), (2, 20));
        assert_eq!((sent.variant, sent.incarnation), (1, 7));
    }

    #[test]
    fn what_was_inherited_is_older_than_all_else() {
        let mut checkpoints = Checkpoints::new(Duration::from_millis(1));
        checkpoints.inherit(41, vec![1]);
        checkpoints.keep(10, &[2]);
        for (before_ns, expected) in [(1, 41), (11, 42)] {
            let (found, broken) = checkpoints.newest_before(before_ns);
            assert_eq!((found.expect("a copy").sequence, broken), (expected, 0));
        }
    }

    #[test]
    fn the_newest_copy_before_the_symptom_is_restored_and_no_broken_one() {
        let mut checkpoints = Checkpoints::new(Duration::from_millis(1));
        assert_eq!(checkpoints.newest_before(u64::MAX), (None, 0));
        for taken_ns in [10, 20, 30, 40] {
            checkpoints.keep(taken_ns, &taken_ns.to_ne_bytes());
        }
        let taken = |checkpoints: &Checkpoints, before_ns| {
            let (found, broken) = checkpoints.newest_before(before_ns);
            (found.map(|found| found.taken_ns), broken)
        };
        for (before_ns, expected) in [
            (u64::MAX, Some(40)),
            (40, Some(30)),
            (21, Some(20)),
            (20, None), // the one of 10 is not kept any more
        ] {
            assert_eq!(taken(&checkpoints, before_ns), (expected, 0), "{before_ns}");
        }
        checkpoints.corrupt();
        assert_eq!(taken(&checkpoints, u64::MAX), (Some(30), 1));
        for copy in &mut checkpoints.copies {
            copy.checksum = !crc32c(&copy.bytes);
        }
        assert_eq!(taken(&checkpoints, u64::MAX), (None, 3));
    }
}
