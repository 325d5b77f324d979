//! Which sequence numbers have come, which are missing, which came twice.

use std::fmt;

use component_sdk::PortData;

/// Numbers that are remembered one by one: with the four counters they are 4 KiB, and as many as a
/// second of a source at 500 Hz.
const REMEMBERED: usize = 508;

/// The account.
#[derive(PortData, Debug, Clone, Copy)]
#[repr(C)]
pub struct Account {
    received: u64,
    missing: u64,
    repeated: u64,
    last: u64,
    /// Each number at its place, by the remainder of its division by [`REMEMBERED`].
    recent: [u64; REMEMBERED],
}

impl Default for Account {
    fn default() -> Self {
        Self {
            received: 0,
            missing: 0,
            repeated: 0,
            last: 0,
            recent: [0; REMEMBERED],
        }
    }
}

impl Account {
    /// The highest number so far; 0 before the first.
    pub fn last(&self) -> u64 {
        self.last
    }

    /// Takes a number in, counted from 1. Of one that is missing it is known only when a later one
    /// has come; before the first one none is missed.
    pub fn take_in(&mut self, sequence: u64) {
        self.received += 1;
        let place = usize::try_from(sequence % REMEMBERED as u64).unwrap_or_default();
        if self.recent[place] == sequence {
            self.repeated += 1;
            return;
        }
        if sequence > self.last {
            if self.last > 0 {
                self.missing += sequence - self.last - 1;
            }
            self.last = sequence;
        } else {
            self.missing = self.missing.saturating_sub(1);
        }
        self.recent[place] = sequence;
    }
}

impl fmt::Display for Account {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            received,
            missing,
            repeated,
            last,
            ..
        } = self;
        write!(
            formatter,
            "received {received}, missing {missing}, repeated {repeated}, last {last}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_4_kib() {
        assert_eq!(size_of::<Account>(), 4096);
    }

    #[test]
    fn missing_and_repeated_numbers_are_counted() {
        let cases: [(&str, &[u64], &str); 6] = [
            (
                "all in order",
                &[1, 2, 3],
                "received 3, missing 0, repeated 0, last 3",
            ),
            (
                "a later beginning",
                &[7, 8],
                "received 2, missing 0, repeated 0, last 8",
            ),
            (
                "a gap",
                &[1, 2, 6],
                "received 3, missing 3, repeated 0, last 6",
            ),
            (
                "twice",
                &[1, 2, 2, 3],
                "received 4, missing 0, repeated 1, last 3",
            ),
            (
                "twice after others",
                &[1, 2, 3, 1],
                "received 4, missing 0, repeated 1, last 3",
            ),
            (
                "late",
                &[1, 3, 2, 2],
                "received 4, missing 0, repeated 1, last 3",
            ),
        ];
        for (case, numbers, expected) in cases {
            let mut account = Account::default();
            for number in numbers {
                account.take_in(*number);
            }
            assert_eq!(account.to_string(), expected, "{case}");
        }
    }
}
