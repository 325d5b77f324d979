//! Faults that are made on purpose: when each begins and ends, and what it does to the data of a
//! port. Pure: time, cycles and data come in; nothing here touches a component.

mod distortion;
mod running;
mod schedule;
mod still_to_come;

pub use distortion::{DistortionError, Passage, PortDistortion};
pub use running::{Changed, InjectionError, Injections};
pub use schedule::{Change, Schedule, TooManyInjections};
pub use still_to_come::still_to_come;

use rand_pcg::Pcg64;

/// What random numbers are drawn for. The simulated world's streams are numbered from 1; these lie
/// far above, two for each injection.
#[derive(Debug, Clone, Copy)]
enum Purpose {
    Chance = 0,
    Noise = 1,
}

const FIRST_STREAM: u128 = 1 << 32;

/// The random numbers of one injection for one purpose in the run with this seed.
fn stream(seed: u64, injection: usize, purpose: Purpose) -> Pcg64 {
    let stream = FIRST_STREAM + 2 * injection as u128 + purpose as u128;
    Pcg64::new(u128::from(seed), stream)
}
