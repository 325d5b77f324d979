//! How well components of this system do that run: their errors by what their ports tell, their use of
//! resources by the container's own figures.

use std::time::Duration;

use system_model::life_cycle::LifeCycleState;
use system_model::task::{ContainerFigure, Placement, QualityAttribute};
use task_adaptation::{Answer, ComponentPerformance, given};

use super::binding::{BoundEvaluator, Part};
use super::local::LocalRobot;

const BYTES_PER_MB: f64 = 1e6;
const PERCENT: f64 = 100.0;

/// The error that an evaluator makes of what it measures: |measured - target| / scale.
pub fn error_of(evaluator: &BoundEvaluator, measured: f64) -> f64 {
    (measured - evaluator.rule.target).abs() / evaluator.rule.scale
}

/// The larger of two errors; what is not a number is the largest of all.
pub fn worse(one: f64, other: f64) -> f64 {
    if one.is_nan() || one > other {
        one
    } else {
        other
    }
}

impl LocalRobot {
    /// What evaluators say of components in use, all of this robot; none where one of them has not
    /// heard anything yet.
    pub fn performances(&self, placements: &[Placement]) -> Option<Answer> {
        let task = &self.binding.task;
        let mut performances = given(task, placements);
        for (placement, performance) in placements.iter().zip(&mut performances) {
            let Some(part) = self.binding.part(*placement) else {
                continue;
            };
            if self.statuses[part.component].state() != LifeCycleState::Active {
                // Whether it is recovered is the fault manager's matter.
                return None;
            }
            if !part.evaluators.is_empty() {
                performance.functional = self.error(part)?;
            }
            self.measure_use(part, performance);
        }
        Some(Answer::Performances(performances))
    }

    /// The largest error of a component that runs; none where an evaluator has not heard anything.
    pub fn error(&self, part: &Part) -> Option<f64> {
        let mut largest: f64 = 0.0;
        for evaluator in &part.evaluators {
            largest = worse(self.measured(evaluator)?, largest);
        }
        Some(largest)
    }

    fn measured(&self, evaluator: &BoundEvaluator) -> Option<f64> {
        let outlet = self.outlet(&evaluator.key)?;
        let measured = match evaluator.rule.attribute {
            QualityAttribute::Age => milliseconds(outlet.age(self.now())),
            QualityAttribute::Value => {
                let newest = outlet.newest()?;
                evaluator.reader.as_ref()?.read(&newest.bytes)
            }
            QualityAttribute::StandardDeviation { .. } => outlet.deviation(evaluator.window?)?,
        };
        Some(error_of(evaluator, measured))
    }

    /// What the container measures of it takes the place of what it is said to need.
    fn measure_use(&self, part: &Part, performance: &mut ComponentPerformance) {
        for (resource, figure) in &part.gauges {
            let status = &self.statuses[part.component];
            let measured = match figure {
                // Callbacks take no time of a simulated clock.
                ContainerFigure::ProcessorLoad if self.environment.clock.is_simulated() => None,
                ContainerFigure::ProcessorLoad => {
                    let load = self.meter.figures(part.component).load_percent;
                    load.map(|percent| percent / PERCENT)
                }
                #[allow(clippy::cast_precision_loss)] // a byte more or less does not matter
                ContainerFigure::MemoryMb => Some(status.allocated_bytes() as f64 / BYTES_PER_MB),
                ContainerFigure::OverrunsPerSecond => self.overruns.per_second(part.component),
            };
            if let (Some(measured), Some(used)) =
                (measured, performance.use_of_resources.get_mut(*resource))
            {
                *used = measured;
            }
        }
    }

    /// What ports tell of the robot's resources is what it has from now on; whether that is new.
    pub fn sense_resources(&mut self) -> bool {
        let mut changed = false;
        for index in 0..self.binding.sensors.len() {
            let sensor = &self.binding.sensors[index];
            let Some(newest) = self.outlet(&sensor.key).and_then(|outlet| outlet.newest()) else {
                continue;
            };
            let amount = sensor.reader.read(&newest.bytes) * sensor.scale;
            let (robot, resource) = (sensor.robot, sensor.resource);
            let available = &mut self.binding.task.robots[robot].available[resource];
            // A sensor that lies does not change what is known.
            if amount.is_finite() && amount >= 0.0 && *available != amount {
                *available = amount;
                changed = true;
            }
        }
        changed
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
