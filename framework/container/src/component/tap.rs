//! What stands between a component and its ports where rules ask for it: checks of the data, the
//! safe value of a command port, samples for process models. A port without rules has none.

mod safe_value;
mod voter;

use std::sync::Arc;
use std::time::Duration;

use fault_manager::detection::Finding;
use fault_manager::detection::data_check::{DataCheck, Violation};
use fault_manager::{DetectorId, Evidence, Number, Observation, Symptom};
use system_model::data_type::DataType;
use system_model::fault::FaultKind;

use crate::injection::{Injections, Passage};
use crate::port::{Datum, Receiver};
use crate::supervision::{Observations, SafetyGate, Sampler};

pub use safe_value::SafeDatum;
pub use voter::{Source as VotingSource, VotedInput};

/// Where and when a port is used.
#[derive(Debug, Clone, Copy)]
pub struct Circumstances<'component> {
    /// Where findings go.
    pub observations: &'component Observations,
    /// Incarnation of the component.
    pub incarnation: u32,
    /// Now, in nanoseconds of the container's clock.
    pub now_ns: u64,
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

/// Checks of the data of one port, with whom they are reported as.
pub struct Watch {
    port: String,
    data_type: DataType,
    check: DataCheck,
    /// By the index of the rule: who complains, and whether it does.
    detectors: Vec<(DetectorId, bool)>,
}

impl Watch {
    /// Checks of a port's data; `detectors` in the order of the check's rules.
    pub fn new(
        port: String,
        data_type: DataType,
        check: DataCheck,
        detectors: Vec<DetectorId>,
    ) -> Self {
        Self {
            port,
            data_type,
            check,
            detectors: detectors.into_iter().map(|id| (id, false)).collect(),
        }
    }

    /// Looks at a datum; whether anything is wrong with it.
    #[inline]
    fn look(&mut self, stamp_ns: u64, bytes: &[u8], at: Circumstances<'_>) -> bool {
        let Self {
            port,
            data_type,
            check,
            detectors,
        } = self;
        check.check(stamp_ns, bytes, &mut |rule, finding| {
            let Some((detector, complaining)) = detectors.get_mut(rule) else {
                return;
            };
            match finding {
                Finding::Passed if *complaining => {
                    *complaining = false;
                    at.observations.report(Observation::Passed(*detector));
                }
                Finding::Passed => {}
                Finding::Violated(violation) => {
                    *complaining = true;
                    complain(*detector, port, data_type, &violation, at);
                }
            }
        })
    }

    /// Another instance writes from now on: what is compared with earlier data begins anew.
    pub fn begin_anew(&mut self) {
        self.check.reset();
    }
}

#[cold]
fn complain(
    detector: DetectorId,
    port: &str,
    data_type: &DataType,
    violation: &Violation,
    at: Circumstances<'_>,
) {
    let port = port.to_owned();
    let field = |index: usize| {
        let field = data_type.fields.get(index);
        field.map_or_else(String::new, |field| field.path.clone())
    };
    let (kind, evidence) = match *violation {
        Violation::Size { size, expected } => (
            FaultKind::WrongSize,
            Evidence::Size {
                port,
                size,
                expected,
            },
        ),
        Violation::Value {
            at,
            value,
            minimum,
            maximum,
        } => (
            FaultKind::OutOfRange,
            Evidence::Value {
                port,
                field: field(at.field),
                value: Number(value),
                minimum,
                maximum,
            },
        ),
        Violation::Jump {
            at,
            value,
            rate_per_second,
            maximum_per_second,
        } => (
            FaultKind::RateOfChange,
            Evidence::Jump {
                port,
                field: field(at.field),
                value: Number(value),
                rate: Number(rate_per_second),
                maximum_per_second,
            },
        ),
        Violation::Standstill { field: of, count } => (
            FaultKind::Stuck,
            Evidence::Frozen {
                port,
                field: of.map_or_else(String::new, field),
                count,
            },
        ),
    };
    at.observations
        .report(Observation::Symptom(Box::new(Symptom {
            detector,
            incarnation: at.incarnation,
            kind,
            return_code: 0,
            at: Duration::from_nanos(at.now_ns),
            runs: true,
            evidence,
        })));
}

/// What stands between a component and one of its outputs.
pub struct OutputTap {
    /// The datum on its way.
    pub scratch: Datum,
    /// Checks.
    pub watch: Option<Watch>,
    /// Process models that want to know.
    pub samplers: Vec<Sampler>,
}

impl OutputTap {
    /// For data of `size` bytes.
    pub fn new(size: usize) -> Self {
        Self {
            scratch: Datum::empty(size),
            watch: None,
            samplers: Vec::new(),
        }
    }

    /// How often the datum on its way goes on: once, unless a fault is injected.
    pub fn distort(&mut self, at: Circumstances<'_>) -> usize {
        if at.injections.is_none() {
            return 1;
        }
        match at.distort(&mut self.scratch) {
            Passage::Deliver => 1,
            Passage::DeliverTwice => 2,
            Passage::Withhold => 0,
        }
    }

    /// Puts the next delayed datum on its way, if there is one.
    pub fn resume(&mut self, at: Circumstances<'_>) -> bool {
        let Some(delayed) = at.due() else {
            return false;
        };
        self.scratch.copy_from(&delayed);
        true
    }

    /// Looks at the datum on its way; whether it is good. A bad one goes on all the same: who reads
    /// it may have rules of its own.
    #[inline]
    pub fn look(&mut self, at: Circumstances<'_>) -> bool {
        for sampler in &self.samplers {
            sampler.sample(at.now_ns, self.scratch.bytes());
        }
        let Some(watch) = &mut self.watch else {
            return true;
        };
        !watch.look(at.now_ns, self.scratch.bytes(), at)
    }
}

/// What stands between one of a component's inputs and the component.
pub struct InputTap {
    /// Checks; a datum that fails one is not delivered, which protects the component.
    pub watch: Option<Watch>,
    /// What is read instead of commands that are stale or from before an emergency stop.
    pub safe: Option<SafeDatum>,
    /// Shut during an emergency stop.
    pub gate: Arc<SafetyGate>,
    /// From which age on data are stale.
    pub maximum_age: Option<Duration>,
    /// Process models that want to know.
    pub samplers: Vec<Sampler>,
    /// Stands in for what is connected.
    pub voter: Option<Box<VotedInput>>,
    /// When the datum was written that was delivered last.
    delivered_ns: u64,
    /// The cycle that has read the safe value: once, or a component that takes all that there is
    /// would never come to an end.
    made_safe_ns: Option<u64>,
    /// A datum that was changed on its way, and whether it is to come once more.
    changed: Option<(Datum, bool)>,
}

impl Default for InputTap {
    /// Without a gate.
    fn default() -> Self {
        Self::new(Arc::default())
    }
}

impl InputTap {
    /// One that lets everything pass.
    pub fn new(gate: Arc<SafetyGate>) -> Self {
        Self {
            watch: None,
            safe: None,
            gate,
            maximum_age: None,
            samplers: Vec::new(),
            voter: None,
            delivered_ns: 0,
            made_safe_ns: None,
            changed: None,
        }
    }

    /// The next datum that the component may see; whether it may be given to a successor, and its
    /// content.
    pub fn receive<'tap>(
        &'tap mut self,
        source: Option<&'tap mut Receiver>,
        at: Circumstances<'_>,
    ) -> Option<(bool, &'tap [u8])> {
        let was_sent = self.voter.is_none();
        let next = match (&mut self.voter, source) {
            (Some(voter), _) => voter.receive(at),
            (None, None) => None,
            (None, Some(source)) if at.injections.is_some() => {
                Self::receive_distorted(&mut self.changed, source, at)
            }
            (None, Some(source)) => source.receive(),
        };
        if let Some(datum) = next {
            let stamp_ns = datum.stamp_ns();
            let watch = self.watch.as_mut();
            let is_good = watch.is_none_or(|watch| !watch.look(stamp_ns, datum.bytes(), at));
            if is_good && self.gate.passes(stamp_ns) {
                self.delivered_ns = stamp_ns;
                for sampler in &self.samplers {
                    sampler.sample(at.now_ns, datum.bytes());
                }
                if let Some(safe) = &mut self.safe {
                    safe.remember(datum.bytes());
                }
                return Some((was_sent, datum.bytes()));
            }
        }
        let is_stale = self.delivered_ns > 0
            && self.maximum_age.is_some_and(|maximum| {
                Duration::from_nanos(at.now_ns.saturating_sub(self.delivered_ns)) > maximum
            });
        if is_stale || !self.gate.passes(self.delivered_ns) {
            let safe = self.safe.as_mut()?;
            let again = self.made_safe_ns.replace(at.now_ns) == Some(at.now_ns);
            return (!again).then(|| (false, safe.at(at.now_ns)));
        }
        None
    }

    /// The next datum, as injected faults leave it.
    #[cold]
    fn receive_distorted<'tap>(
        changed: &'tap mut Option<(Datum, bool)>,
        source: &mut Receiver,
        at: Circumstances<'_>,
    ) -> Option<&'tap Datum> {
        let repeated = changed.as_mut().is_some_and(|it| std::mem::take(&mut it.1));
        if !repeated {
            *changed = match at.due() {
                Some(delayed) => Some((delayed, false)),
                None => source.receive().and_then(|datum| {
                    let mut datum = datum.clone();
                    match at.distort(&mut datum) {
                        Passage::Deliver => Some((datum, false)),
                        Passage::DeliverTwice => Some((datum, true)),
                        Passage::Withhold => None,
                    }
                }),
            };
        }
        changed.as_ref().map(|(datum, _)| datum)
    }
}
