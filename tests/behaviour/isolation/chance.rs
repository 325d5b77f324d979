//! Numbers that look random and are the same in every run.

/// A generator, by xorshift64.
pub(super) struct Chance(u64);

impl Chance {
    /// The one of this seed.
    pub(super) fn new(seed: u64) -> Self {
        // Odd multiplier of Knuth's hash: small seeds give unlike beginnings, none of them zero.
        Self((seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    /// A number below `bound`.
    pub(super) fn below(&mut self, bound: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % bound
    }

    /// An index of a list of this length.
    pub(super) fn index(&mut self, length: usize) -> usize {
        usize::try_from(self.below(length as u64)).unwrap_or_default()
    }
}
