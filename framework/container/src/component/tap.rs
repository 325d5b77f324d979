//! What stands between a component and its ports where rules ask for it: checks of the data, the
//! safe value of a command port, samples for process models. A port without rules has none.

mod input;
mod output;
mod safe_value;
mod voter;
mod watch;

use std::time::Duration;

use crate::injection::{Injections, Passage};
use crate::port::Datum;
use crate::supervision::Observations;

pub use input::InputTap;
pub use output::OutputTap;
pub use safe_value::SafeDatum;
pub use voter::{Source as VotingSource, VotedInput};
pub use watch::Watch;

/// Where and when a port is used.
#[derive(Debug, Clone, Copy)]
pub struct Circumstances<'component> {
    /// Where findings go.
    pub observations: &'component Observations,
    /// Incarnation of the component.
    pub incarnation: u32,
    /// Now, in nanoseconds of the container's clock.
    pub now_ns: u64,
    /// Under which time a recording has it.
    pub seen_ns: u64,
    /// Faults that are made on purpose, if there are any, with the component's and the port's
    /// number.
    pub injections: Option<(&'component Injections, usize, usize)>,
}

impl Circumstances<'_> {
    fn distort(&self, datum: &mut Datum) -> Passage {
        let now = Duration::from_nanos(self.now_ns);
        self.injections
            .map_or(Passage::Deliver, |(injections, component, port)| {
                injections.distort(component, port, datum, now)
            })
    }

    fn due(&self) -> Option<Datum> {
        let (injections, component, port) = self.injections?;
        injections.due(component, port, Duration::from_nanos(self.now_ns))
    }
}
