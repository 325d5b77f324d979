//! How a callback in a host ended, and what is to go wrong in one, as words.

use std::time::Duration;

use component_abi::Status;

use super::channel::WORD_COUNT;
use super::message::{number, size};
use crate::guard::{Ending, Exit, Misbehaviour, Registers, Trap};

/// Words of an ending.
const WORDS: usize = WORD_COUNT - 2;

/// How a callback ended, with what else is to be said then.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct HostEnding {
    /// How it ended.
    pub(super) ending: Ending,
    /// A fault that a thread of the component's own has met.
    pub(super) stray: Option<Trap>,
    /// Bytes that callbacks have allocated and not freed, where that is counted.
    pub(super) allocated_bytes: u64,
    /// When it misbehaved as it was made to, by the machine's monotonic clock; 0 if it never did.
    pub(super) misbehaved_ns: u64,
}

impl HostEnding {
    pub(super) fn words(&self) -> [u64; WORDS] {
        let mut words = [0; WORDS];
        let [kind, argument, trap] = match self.ending {
            Ending::Returned(status) => [1, u64::from(status.0), 0],
            Ending::Trapped(_) => [2, 0, 1],
            Ending::Left(Exit::Abort) => [3, 0, 0],
            Ending::Left(Exit::Exit(code)) => [4, u64::from(code.cast_unsigned()), 0],
            Ending::Gone | Ending::HostEnded => [5, 0, 0],
        };
        words[0] = kind;
        words[1] = argument;
        words[2] = self.allocated_bytes;
        words[14] = self.misbehaved_ns;
        if trap == 1
            && let Ending::Trapped(trap) = self.ending
        {
            words[3..8].copy_from_slice(&trap_words(&trap));
        }
        if let Some(stray) = self.stray {
            words[8] = 1;
            words[9..14].copy_from_slice(&trap_words(&stray));
        }
        words
    }

    pub(super) fn from_words(words: [u64; WORDS]) -> Option<Self> {
        let ending = match words[0] {
            1 => Ending::Returned(Status(number(words[1])?)),
            2 => Ending::Trapped(trap(&words[3..8])?),
            3 => Ending::Left(Exit::Abort),
            4 => Ending::Left(Exit::Exit(number(words[1])?.cast_signed())),
            5 => Ending::Gone,
            _ => return None,
        };
        let stray = match words[8] {
            0 => None,
            _ => Some(trap(&words[9..14])?),
        };
        Some(Self {
            ending,
            stray,
            allocated_bytes: words[2],
            misbehaved_ns: words[14],
        })
    }
}

fn trap_words(trap: &Trap) -> [u64; 5] {
    [
        u64::from(trap.signal.cast_unsigned()),
        u64::from(trap.code.cast_unsigned()),
        trap.address as u64,
        u64::from(trap.stack_overflow),
        trap.hang.map_or(0, crate::clock::nanoseconds),
    ]
}

/// Registers stay behind: they say something in the host only.
fn trap(words: &[u64]) -> Option<Trap> {
    Some(Trap {
        signal: number(words[0])?.cast_signed(),
        code: number(words[1])?.cast_signed(),
        address: size(words[2])?,
        registers: Registers::default(),
        stack_overflow: words[3] != 0,
        hang: (words[4] > 0).then(|| Duration::from_nanos(words[4])),
    })
}

pub(super) fn misbehaviour_words(misbehaviour: Option<Misbehaviour>) -> [u64; 2] {
    match misbehaviour {
        None => [0, 0],
        Some(Misbehaviour::Panic) => [1, 0],
        Some(Misbehaviour::Segfault) => [2, 0],
        Some(Misbehaviour::BusError) => [3, 0],
        Some(Misbehaviour::DivideByZero) => [4, 0],
        Some(Misbehaviour::IllegalInstruction) => [5, 0],
        Some(Misbehaviour::Abort) => [6, 0],
        Some(Misbehaviour::StackOverflow) => [7, 0],
        Some(Misbehaviour::Exit) => [8, 0],
        Some(Misbehaviour::Hang) => [9, 0],
        Some(Misbehaviour::Slow(time)) => [10, crate::clock::nanoseconds(time)],
        Some(Misbehaviour::Leak(bytes)) => [11, bytes as u64],
        Some(Misbehaviour::ErrorReturn(status)) => [12, status.into()],
    }
}

/// `None`: no such misbehaviour.
pub(super) fn misbehaviour([kind, argument]: [u64; 2]) -> Option<Option<Misbehaviour>> {
    Some(match kind {
        0 => None,
        1 => Some(Misbehaviour::Panic),
        2 => Some(Misbehaviour::Segfault),
        3 => Some(Misbehaviour::BusError),
        4 => Some(Misbehaviour::DivideByZero),
        5 => Some(Misbehaviour::IllegalInstruction),
        6 => Some(Misbehaviour::Abort),
        7 => Some(Misbehaviour::StackOverflow),
        8 => Some(Misbehaviour::Exit),
        9 => Some(Misbehaviour::Hang),
        10 => Some(Misbehaviour::Slow(Duration::from_nanos(argument))),
        11 => Some(Misbehaviour::Leak(size(argument)?)),
        12 => Some(Misbehaviour::ErrorReturn(number(argument)?)),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_comes_over_without_the_registers() {
        let trap = Trap {
            signal: libc::SIGSEGV,
            code: -6,
            address: 0xdead_beef,
            registers: Registers::default(),
            stack_overflow: true,
            hang: Some(Duration::from_millis(30)),
        };
        for ending in [
            Ending::Returned(Status::PANICKED),
            Ending::Trapped(trap),
            Ending::Left(Exit::Abort),
            Ending::Left(Exit::Exit(-1)),
            Ending::Gone,
        ] {
            for stray in [None, Some(trap)] {
                let said = HostEnding {
                    ending,
                    stray,
                    allocated_bytes: 7,
                    misbehaved_ns: 8,
                };
                assert_eq!(HostEnding::from_words(said.words()), Some(said));
            }
        }
    }

    #[test]
    fn every_misbehaviour_comes_over() {
        for argument in 0..=12 {
            let injection = misbehaviour([argument, 3]).expect("a known one");
            let words = misbehaviour_words(injection);
            assert_eq!(misbehaviour(words), Some(injection));
        }
        assert_eq!(misbehaviour([13, 0]), None);
    }
}
