//! Data through ports, of which nothing is known but whether they are right, and who looks at them.

mod distortion;
mod votes;
mod watch;
mod wiring;

use std::time::Duration;

use system_model::fault::FaultKind;

use self::distortion::distort;
pub(super) use self::wiring::Wiring;
use super::{BEGIN, StandIn};
use crate::evidence::{Evidence, Number};
use crate::observation::{DetectorId, Observation, Symptom};

/// One datum, without its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Datum {
    /// When it was written.
    pub stamp: Duration,
    /// Its values are far outside of everything.
    pub far: bool,
    /// Its values are no numbers.
    pub no_number: bool,
    /// It is the same as the one before.
    pub same: bool,
    /// Its values have nothing to do with those before.
    pub wild: bool,
    /// It was delayed.
    pub late: bool,
}

impl Datum {
    /// A right one.
    fn new(stamp: Duration) -> Self {
        Self {
            stamp,
            ..Self::default()
        }
    }

    fn is_wrong(self) -> bool {
        self.far || self.no_number || self.same || self.late
    }

    /// What is made of it and another one.
    fn with(self, other: Self) -> Self {
        Self {
            stamp: self.stamp,
            far: self.far || other.far,
            no_number: self.no_number || other.no_number,
            same: self.same || other.same,
            wild: self.wild || other.wild,
            late: self.late || other.late,
        }
    }
}

/// A port, by the number of its component and its name.
pub(super) type Port = (usize, String);

impl StandIn<'_> {
    /// A component takes what there is at all its inputs. What fails a check does not come to it.
    pub(super) fn read(&mut self, component: usize) {
        for port in self.wiring.inputs_of(component) {
            self.vote(&port);
            for datum in self.taken(&port) {
                let Some(input) = self.wiring.input(&port) else {
                    continue;
                };
                let (passes, findings) = input.watch.look(datum);
                self.find(component, &port.1, findings);
                if passes {
                    self.take(&port, datum);
                }
            }
        }
    }

    /// What waits at an input, as the misfortune leaves it.
    fn taken(&mut self, port: &Port) -> Vec<Datum> {
        let distortion = self.misfortune.distortion(port.0, &port.1, self.now);
        let now = self.now;
        let Some(input) = self.wiring.input(port) else {
            return Vec::new();
        };
        let waiting = std::mem::take(&mut input.waiting);
        let waiting = waiting.into_iter();
        waiting
            .flat_map(|datum| distort(datum, distortion, now, &mut input.delayed))
            .collect()
    }

    /// A datum has come to a component.
    fn take(&mut self, port: &Port, datum: Datum) {
        let now = self.now;
        if let Some(input) = self.wiring.input(port) {
            if let Some(before) = input.delivered.filter(|_| now < BEGIN) {
                input.usual = input.usual.max(now.saturating_sub(before));
            }
            input.delivered = Some(now);
            input.last = datum;
        }
        self.sample(port, datum);
        if datum.is_wrong() {
            self.misfortune.reaches(port.0);
        }
    }

    /// A component sends a datum from each of its outputs: a right one, but for what it passes on.
    pub(super) fn write(&mut self, component: usize) {
        let now = self.now;
        let made_of = self.wiring.passing_inputs(component);
        if now >= BEGIN && made_of.clone().any(|input| input.is_silent(now)) {
            return;
        }
        let made = made_of.fold(Datum::new(now), |made, input| made.with(input.last));
        for port in self.wiring.outputs_of(component) {
            let distortion = self.misfortune.distortion(component, &port.1, now);
            let Some(output) = self.wiring.output(&port) else {
                continue;
            };
            let data = distort(made, distortion, now, &mut output.delayed);
            for datum in data {
                self.send(&port, datum);
            }
        }
    }

    fn send(&mut self, port: &Port, datum: Datum) {
        let Some(output) = self.wiring.output(port) else {
            return;
        };
        let (_, findings) = output.watch.look(datum);
        let targets = output.targets.clone();
        self.find(port.0, &port.1, findings);
        self.sample(port, datum);
        self.wiring.hear(port, datum);
        for target in targets {
            if let Some(input) = self.wiring.input(&target) {
                input.receive(datum);
                self.wake(target.0);
            }
        }
    }

    fn find(
        &mut self,
        component: usize,
        port: &str,
        findings: Vec<(DetectorId, Option<FaultKind>)>,
    ) {
        for (detector, kind) in findings {
            match kind {
                Some(kind) => self.complain(component, detector, kind, port),
                None => self.observe(Observation::Passed(detector)),
            }
        }
    }

    /// A symptom of a component that runs.
    pub(super) fn complain(
        &mut self,
        component: usize,
        detector: DetectorId,
        kind: FaultKind,
        port: &str,
    ) {
        let symptom = Symptom {
            detector,
            incarnation: self.components[component].incarnation,
            kind,
            return_code: 0,
            at: self.now,
            runs: true,
            evidence: Evidence::Value {
                port: port.to_owned(),
                field: String::new(),
                value: Number(f64::NAN),
                minimum: None,
                maximum: None,
            },
        };
        self.observe(Observation::Symptom(Box::new(symptom)));
    }

    /// A new instance: what is compared with earlier data begins anew.
    pub(super) fn begin_anew(&mut self, component: usize) {
        for port in self.wiring.outputs_of(component) {
            if let Some(output) = self.wiring.output(&port) {
                output.watch.begin_anew();
            }
        }
    }
}
