//! What an injection does to the data of one port.

mod field;

use std::collections::VecDeque;
use std::time::Duration;

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use system_model::data_type::DataType;
use system_model::injection::Distortion;

use super::{Purpose, stream};
use crate::port::Datum;
use field::{Target, targets};

/// So many delayed data are kept: those of a port of 50 Hz for more than a minute.
const MAX_DELAYED: usize = 4096;

/// Delayed data of one port take no more memory than this: a minute of the reference robot's
/// pictures would need twice as much, a second needs a thirtieth.
const MAX_DELAYED_BYTES: usize = 16 * 1024 * 1024;

/// One distortion of one port: which numbers of a datum it changes, and what it remembers.
///
/// It begins with the first datum that it is given, and again after [`PortDistortion::restart`].
#[derive(Debug)]
pub struct PortDistortion {
    distortion: Distortion,
    size: usize,
    targets: Vec<Target>,
    random: Pcg64,
    begun: Option<Duration>,
    stuck_at: Option<Datum>,
    delayed: VecDeque<(Duration, Datum)>,
    lost: u64,
}

/// What becomes of a datum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passage {
    /// It goes on, changed or not.
    Deliver,
    /// It goes on twice.
    DeliverTwice,
    /// It does not go on; a delayed one comes back from [`PortDistortion::due`].
    Withhold,
}

/// A distortion that does not fit the data of its port.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DistortionError {
    /// The type has no field of this name.
    #[error("{data_type} has no field '{field}'; it has: {known}")]
    UnknownField {
        /// Name of the type.
        data_type: String,
        /// The field as written.
        field: String,
        /// All its fields.
        known: String,
    },
    /// Only integers, which are always numbers.
    #[error("of {data_type} nothing that is asked for can be 'not a number': it is whole numbers")]
    OnlyIntegers {
        /// Name of the type.
        data_type: String,
    },
    /// The type says nothing of its inside.
    #[error("{data_type} has no fields that could be changed")]
    NoFields {
        /// Name of the type.
        data_type: String,
    },
}

impl PortDistortion {
    /// A distortion of data of a type: of the field of this path, or without one of all but those
    /// that are called `time`. `injection` is its number in the [`Schedule`](super::Schedule); the
    /// noise is that of the run's seed.
    ///
    /// # Errors
    /// If the type has no such field, or none that could be changed so.
    pub fn new(
        data_type: &DataType,
        field: Option<&str>,
        distortion: Distortion,
        seed: u64,
        injection: usize,
    ) -> Result<Self, DistortionError> {
        Ok(Self {
            distortion,
            size: data_type.size,
            targets: targets(data_type, field, distortion)?,
            random: stream(seed, injection, Purpose::Noise),
            begun: None,
            stuck_at: None,
            delayed: VecDeque::new(),
            lost: 0,
        })
    }

    /// Forgets the value that is stuck and when a drift began. Delayed data stay: they are still to
    /// be delivered.
    pub fn restart(&mut self) {
        self.begun = None;
        self.stuck_at = None;
    }

    /// Distorts a datum and says what becomes of it. A datum of another size than its type has is
    /// left alone.
    pub fn apply(&mut self, datum: &mut Datum, now: Duration) -> Passage {
        if datum.bytes().len() != self.size {
            return Passage::Deliver;
        }
        let begun = *self.begun.get_or_insert(now);
        match self.distortion {
            Distortion::Drop => return Passage::Withhold,
            Distortion::Duplicate => return Passage::DeliverTwice,
            Distortion::Delay(delay) => {
                self.delay(datum, now.saturating_add(delay));
                return Passage::Withhold;
            }
            Distortion::Stuck => self.stick(datum),
            Distortion::OutOfRange(value) => self.each(datum, |target, bytes, _| {
                target.set(bytes, value);
            }),
            Distortion::NotANumber => self.each(datum, |target, bytes, _| {
                target.set(bytes, f64::NAN);
            }),
            Distortion::Offset(value) => self.each(datum, |target, bytes, _| {
                target.add(bytes, || value);
            }),
            Distortion::Drift(per_second) => {
                let drift = per_second * now.saturating_sub(begun).as_secs_f64();
                self.each(datum, |target, bytes, _| target.add(bytes, || drift));
            }
            Distortion::Noise(deviation) => self.each(datum, |target, bytes, random| {
                target.add(bytes, || {
                    let normal: f64 = StandardNormal.sample(random);
                    deviation * normal
                });
            }),
        }
        Passage::Deliver
    }

    /// The next delayed datum whose time has come, with the origin that it had; call it until there
    /// is none. Data come out in the order they went in.
    pub fn due(&mut self, now: Duration) -> Option<Datum> {
        let (time, _) = self.delayed.front()?;
        if *time > now {
            return None;
        }
        self.delayed.pop_front().map(|(_, datum)| datum)
    }

    /// How many data were lost because too many were delayed.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    fn each(&mut self, datum: &mut Datum, mut change: impl FnMut(&Target, &mut [u8], &mut Pcg64)) {
        for target in &self.targets {
            change(target, datum.bytes_mut(), &mut self.random);
        }
    }

    fn stick(&mut self, datum: &mut Datum) {
        let stuck = self.stuck_at.get_or_insert_with(|| datum.clone());
        for target in &self.targets {
            target.copy(datum.bytes_mut(), stuck.bytes());
        }
    }

    /// Where too many wait already the newest is lost, so that the others are as late as was asked.
    fn delay(&mut self, datum: &Datum, until: Duration) {
        let room = (MAX_DELAYED_BYTES / self.size.max(1)).clamp(1, MAX_DELAYED);
        if self.delayed.len() >= room {
            self.lost += 1;
        } else {
            self.delayed.push_back((until, datum.clone()));
        }
    }
}

#[cfg(test)]
mod tests;
