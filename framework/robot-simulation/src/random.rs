//! Seeded random numbers, one independent stream for each purpose.

use rand_pcg::Pcg64;

/// What the numbers are for. A stream of its own for each, so that one more draw for one purpose
/// never changes another.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Purpose {
    Arena = 1,
    SonarNoise = 2,
    CameraNoise = 3,
}

/// The stream of one purpose in the run with this seed.
pub(crate) fn stream(seed: u64, purpose: Purpose) -> Pcg64 {
    Pcg64::new(u128::from(seed), purpose as u128)
}
