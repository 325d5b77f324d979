//! Process-model monitors: ports leave samples, the monitor compares them with its model when the
//! fault manager's time comes.

use std::sync::Arc;
use std::time::Duration;

use crossbeam::queue::ArrayQueue;
use fault_manager::detection::process_model::{InputMap, Monitor, Residual, ResidualMonitor};
use fault_manager::detection::{Finding, NumberReader};
use fault_manager::{DetectorId, Evidence, Number, Observation, Symptom};
use system_model::data_type::{DataType, Field, Scalar};
use system_model::fault::FaultKind;

use super::Observations;
use crate::recording::{EventRecorder, PortRecorder};
use crate::status::ComponentStatus;

/// Samples that may wait for a monitor: those of a hundred milliseconds at a kilohertz from ten
/// ports. More are dropped, and the monitor goes on with those that come.
const QUEUE: usize = 1024;

/// Inputs and outputs that one port can have for a model.
const MOST_VALUES: usize = 8;

/// What one port said.
#[derive(Debug, Clone, Copy)]
struct Sample {
    at_ns: u64,
    /// Of which port: an index into inputs or outputs.
    channel: Channel,
    values: [f64; MOST_VALUES],
}

/// Where the values of a port begin in the model's input or output vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Inputs from this one on.
    Input(usize),
    /// This output.
    Output(usize),
}

/// How a port's datum is read.
pub enum Reading {
    /// One number of it.
    Number(NumberReader),
    /// The model's inputs, reckoned from it.
    Inputs(InputMap),
}

/// The end of a monitor at a port.
pub struct Sampler {
    samples: Arc<ArrayQueue<Sample>>,
    channel: Channel,
    reading: Reading,
}

impl Sampler {
    /// Leaves a sample of a datum. Never waits.
    pub fn sample(&self, at_ns: u64, bytes: &[u8]) {
        let mut values = [f64::NAN; MOST_VALUES];
        match &self.reading {
            Reading::Number(reader) => values[0] = reader.read(bytes),
            Reading::Inputs(map) => {
                if let Some(values) = values.get_mut(..map.inputs()) {
                    map.read(bytes, values);
                }
            }
        }
        let sample = Sample {
            at_ns,
            channel: self.channel,
            values,
        };
        // Dropped: the monitor is behind by a hundred milliseconds and tolerates missing samples.
        let _dropped = self.samples.push(sample);
    }
}

/// What the process is compared with.
pub enum Reference {
    /// A model in state space, which gets the same inputs.
    Model(Box<Monitor>),
    /// A component that plays the model: it gets the same inputs by connections of the application,
    /// and its outputs are the model's. So many are compared.
    Component(Box<ResidualMonitor>, usize),
}

impl Reference {
    /// Numbers of inputs and outputs.
    fn size(&self) -> (usize, usize) {
        match self {
            Self::Model(monitor) => (monitor.model().inputs(), monitor.model().outputs()),
            Self::Component(_, outputs) => (*outputs, *outputs),
        }
    }

    fn step(&mut self, at: Duration, inputs: &[f64], outputs: &[f64]) -> Option<Finding<Residual>> {
        match self {
            Self::Model(monitor) => monitor.step(at, inputs, outputs),
            Self::Component(monitor, _) => monitor.step(at, inputs, outputs),
        }
    }

    fn reset(&mut self) {
        match self {
            Self::Model(monitor) => monitor.reset(),
            Self::Component(monitor, _) => monitor.reset(),
        }
    }

    /// Residuals of the last step, and what the decision rule made of all so far.
    fn figures(&self) -> (&[f64], f64) {
        match self {
            Self::Model(monitor) => (monitor.residuals(), monitor.statistic()),
            Self::Component(monitor, _) => (monitor.residuals(), monitor.statistic()),
        }
    }
}

/// A monitor with its samples.
pub struct ModelMonitor {
    name: String,
    method: &'static str,
    detector: DetectorId,
    /// The component that is to blame.
    status: Arc<ComponentStatus>,
    incarnation: u32,
    samples: Arc<ArrayQueue<Sample>>,
    reference: Reference,
    /// What goes into the model, or what the reference component says.
    inputs: Vec<f64>,
    outputs: Vec<f64>,
    /// Which outputs have had a sample since the last step.
    sampled: Vec<bool>,
    complaining: bool,
    /// Where figures are recorded.
    recorder: Option<EventRecorder>,
}

impl ModelMonitor {
    /// A monitor that has seen nothing.
    pub fn new(
        name: String,
        method: &'static str,
        detector: DetectorId,
        status: Arc<ComponentStatus>,
        reference: Reference,
    ) -> Self {
        let (inputs, outputs) = reference.size();
        Self {
            name,
            method,
            detector,
            incarnation: status.incarnation(),
            status,
            samples: Arc::new(ArrayQueue::new(QUEUE)),
            reference,
            inputs: vec![f64::NAN; inputs],
            outputs: vec![f64::NAN; outputs],
            sampled: vec![false; outputs],
            complaining: false,
            recorder: None,
        }
    }

    /// What is recorded of it: the component that is to blame, a name that no port has, and the type
    /// of the figures, `statistic` and `residuals`.
    pub fn recorded(&self) -> (&str, String, DataType) {
        let name = format!("{}:residual", self.name);
        let field = |path: &str, offset, count| Field {
            path: path.to_owned(),
            unit: String::new(),
            offset,
            scalar: Scalar::F64,
            count,
        };
        let count = self.outputs.len();
        let data_type = DataType {
            name: "Residual".to_owned(),
            size: (1 + count) * size_of::<f64>(),
            layout_hash: 0,
            fields: vec![
                field("statistic", 0, 1),
                field("residuals", size_of::<f64>(), count),
            ],
        };
        (&self.status.name, name, data_type)
    }

    /// From now on the figures of each step are recorded.
    pub fn record_by(&mut self, port: PortRecorder) {
        let size = (1 + self.outputs.len()) * size_of::<f64>();
        let scratch = vec![0; size].into_boxed_slice();
        self.recorder = Some(EventRecorder { scratch, port });
    }

    /// The end for a port.
    pub fn sampler(&self, channel: Channel, reading: Reading) -> Sampler {
        Sampler {
            samples: Arc::clone(&self.samples),
            channel,
            reading,
        }
    }

    /// Compares what has come with the model.
    pub(super) fn poll(&mut self, observations: &Observations) {
        if self.status.incarnation() != self.incarnation {
            self.incarnation = self.status.incarnation();
            self.reference.reset();
        }
        while let Some(sample) = self.samples.pop() {
            match sample.channel {
                Channel::Input(first) => {
                    for (place, value) in self.inputs.iter_mut().skip(first).zip(sample.values) {
                        *place = value;
                    }
                }
                Channel::Output(index) => {
                    if let Some(place) = self.outputs.get_mut(index) {
                        *place = sample.values[0];
                        self.sampled[index] = true;
                    }
                    if self.sampled.iter().all(|sampled| *sampled) {
                        self.sampled.fill(false);
                        self.step(sample.at_ns, observations);
                    }
                }
            }
        }
    }

    /// One step of the model, once every output has come.
    fn step(&mut self, at_ns: u64, observations: &Observations) {
        let at = Duration::from_nanos(at_ns);
        let finding = self.reference.step(at, &self.inputs, &self.outputs);
        if finding.is_some() {
            self.record(at_ns);
        }
        match finding {
            Some(Finding::Passed) if self.complaining => {
                self.complaining = false;
                observations.report(Observation::Passed(self.detector));
            }
            None | Some(Finding::Passed) => {}
            Some(Finding::Violated(residual)) => {
                self.complaining = true;
                observations.report(Observation::Symptom(Box::new(self.symptom(at, &residual))));
            }
        }
    }

    fn record(&mut self, at_ns: u64) {
        let Some(EventRecorder { scratch, port }) = &mut self.recorder else {
            return;
        };
        let (residuals, statistic) = self.reference.figures();
        let figures = std::iter::once(&statistic).chain(residuals);
        for (place, figure) in scratch.chunks_exact_mut(size_of::<f64>()).zip(figures) {
            place.copy_from_slice(&figure.to_ne_bytes());
        }
        port.record(at_ns, at_ns, scratch);
    }

    fn symptom(&self, at: Duration, residual: &Residual) -> Symptom {
        Symptom {
            detector: self.detector,
            incarnation: self.incarnation,
            kind: FaultKind::ProcessModel,
            return_code: 0,
            at,
            runs: true,
            evidence: Evidence::Residual {
                monitor: self.name.clone(),
                method: self.method.to_owned(),
                residual: Number(residual.residual),
                statistic: Number(residual.statistic),
                threshold: residual.threshold,
            },
        }
    }
}
