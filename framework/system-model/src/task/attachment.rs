//! How a task's parts meet a running application: which subcomponents they are, what is measured of
//! them, what is measured of the robot. A task that is only planned needs none of it.

use std::time::Duration;

use super::ResourceIndex;
use crate::profile::Located;
use crate::specification::Place;

/// What an instance is in the application of its robot, and how well it does there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Attachment {
    /// Name of its subcomponent in the application; none: that of the component.
    pub subcomponent: Option<String>,
    /// What tells its functional error P_cf; of several the largest counts.
    pub evaluators: Vec<Located<Evaluator>>,
    /// How its error is estimated while it does not run; none: by its evaluators.
    pub estimator: Option<Located<Estimator>>,
    /// Resources of which its use is measured by the container, instead of what it is said to need.
    pub gauges: Vec<(ResourceIndex, ContainerFigure)>,
    /// Where the instance is written.
    pub place: Place,
}

/// A quality attribute of an output port, as a functional error: |measured - target| / scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluator {
    /// The output port; one that the component itself evaluates by is such a port, too.
    pub port: String,
    /// The field; none where the datum has only one number, or its age is measured.
    pub field: Option<String>,
    /// What is measured.
    pub attribute: QualityAttribute,
    /// What it should be, in the unit of what is measured.
    pub target: f64,
    /// How far from there is an error of 1; above 0.
    pub scale: f64,
}

/// What is measured of a port's data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QualityAttribute {
    /// The field's newest value.
    Value,
    /// The field's standard deviation over so many data; nothing is known before that many came.
    StandardDeviation {
        /// How many, at least 2.
        window: usize,
    },
    /// How long ago the newest datum was written, in milliseconds.
    Age,
}

/// How a component that does not run is estimated.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimator {
    /// An output port and a field of it that hold the estimated error, where the component brings an
    /// estimator of its own; none: its evaluators look at what it writes.
    pub own: Option<(String, Option<String>)>,
    /// For how many cycles it is run on the current inputs; the last one counts.
    pub cycles: u32,
}

impl Default for Estimator {
    /// One cycle, as in the paper.
    fn default() -> Self {
        Self {
            own: None,
            cycles: 1,
        }
    }
}

/// What the container measures of a component that runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContainerFigure {
    /// The part of a core that its executor uses. No time passes in simulated callbacks, so there what
    /// the component is said to need counts.
    ProcessorLoad,
    /// Memory that its callbacks have allocated and not freed, in megabytes.
    MemoryMb,
    /// Cycles of its executor that took longer than their period, a second.
    OverrunsPerSecond,
}

/// What a robot has of a resource, as a port tells it: a battery, for example.
#[derive(Debug, Clone, PartialEq)]
pub struct ResourceSensor {
    /// Which resource.
    pub resource: ResourceIndex,
    /// Name of the subcomponent.
    pub subcomponent: String,
    /// Its output port.
    pub port: String,
    /// The field; none where the datum has only one number.
    pub field: Option<String>,
    /// The field's value times this is what the robot has, in the resource's unit.
    pub scale: f64,
}

/// The ports of a link where several could be meant.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LinkPorts {
    /// Output of the first component.
    pub output: Option<String>,
    /// Input of the last component.
    pub input: Option<String>,
    /// Input and output of each component that may be put in between, in the order of the link.
    pub through: Vec<(Option<String>, Option<String>)>,
    /// Where the link is written.
    pub place: Place,
}

/// How often what runs is evaluated where a file says nothing: a person does not notice what lasts
/// shorter, and looking costs microseconds.
pub const DEFAULT_EVALUATION_PERIOD: Duration = Duration::from_millis(20);
