//! The last times, kept without allocating.

use std::fmt;

/// What is written down; as text one JSON object, all numbers in nanoseconds.
#[derive(Debug, Default)]
pub struct Record {
    /// When the first cycle began, by the machine's clock and by the container's.
    first_ns: u64,
    first_by_container_ns: u64,
    /// When the last cycle began.
    last_ns: u64,
    /// From the beginning of one cycle to that of the next.
    cycles: Latest,
    /// From sending to receiving.
    passages: Latest,
}

/// The latest numbers, in no order.
#[derive(Debug, Default)]
struct Latest {
    numbers: Vec<u64>,
    count: usize,
}

impl Record {
    /// Room for so many times of each kind.
    pub fn new(capacity: usize) -> Self {
        Self {
            first_ns: 0,
            first_by_container_ns: 0,
            last_ns: 0,
            cycles: Latest::new(capacity),
            passages: Latest::new(capacity),
        }
    }

    /// A cycle begins; `by_container_ns` is asked in the first one.
    pub fn cycle(&mut self, now_ns: u64, by_container_ns: impl FnOnce() -> u64) {
        if self.first_ns == 0 {
            self.first_ns = now_ns;
            self.first_by_container_ns = by_container_ns();
        } else {
            self.cycles.keep(now_ns.saturating_sub(self.last_ns));
        }
        self.last_ns = now_ns;
    }

    /// A datum of this age has arrived.
    pub fn passage(&mut self, age_ns: u64) {
        self.passages.keep(age_ns);
    }
}

impl Latest {
    fn new(capacity: usize) -> Self {
        Self {
            // Not zeros: those would be pages that are not there until the first cycles want them.
            numbers: vec![u64::MAX; capacity],
            count: 0,
        }
    }

    fn keep(&mut self, number: u64) {
        if self.numbers.is_empty() {
            return;
        }
        let place = self.count % self.numbers.len();
        self.numbers[place] = number;
        self.count += 1;
    }

    fn kept(&self) -> &[u64] {
        &self.numbers[..self.count.min(self.numbers.len())]
    }
}

impl fmt::Display for Record {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            formatter,
            "{{\"first_ns\":{},\"first_by_container_ns\":{},\"cycles_ns\":{:?},\
             \"passages_ns\":{:?}}}",
            self.first_ns,
            self.first_by_container_ns,
            self.cycles.kept(),
            self.passages.kept(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_times_are_kept() {
        let cases: [(usize, &[u64], &str); 4] = [
            (2, &[], "0 0 [] []"),
            (2, &[10], "10 7 [] [1]"),
            (2, &[10, 30, 60, 100], "10 7 [40, 30] [3, 4]"),
            (0, &[10, 30], "10 7 [] []"),
        ];
        for (capacity, starts, expected) in cases {
            let mut record = Record::new(capacity);
            for (age_ns, start_ns) in (1..).zip(starts) {
                record.cycle(*start_ns, || 7);
                record.passage(age_ns);
            }
            let kept = format!(
                "{} {} {:?} {:?}",
                record.first_ns,
                record.first_by_container_ns,
                record.cycles.kept(),
                record.passages.kept()
            );
            assert_eq!(kept, expected);
        }
    }
}
