//! A tap on an input.

use std::sync::Arc;
use std::time::Duration;

use super::{Circumstances, SafeDatum, VotedInput, Watch};
use crate::injection::Passage;
use crate::port::{Datum, Receiver};
use crate::recording::PortRecorder;
use crate::supervision::{SafetyGate, Sampler};

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
    /// Who puts down what arrives, and the safe value where that is read instead.
    pub recorder: Option<PortRecorder>,
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
            recorder: None,
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
            if let Some(recorder) = &mut self.recorder {
                recorder.record(at.seen_ns, stamp_ns, datum.bytes());
            }
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
            if again {
                return None;
            }
            let value = safe.at(at.now_ns);
            if let Some(recorder) = &mut self.recorder {
                recorder.record(at.seen_ns, at.now_ns, value);
            }
            return Some((false, value));
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
