//! What a task's instances are in a running application, and what is measured there.
//!
//! ```xml
//! <robot name="R1">
//!   <has resource="power" amount="8"/>
//!   <gauge resource="power" subcomponent="battery" port="state" field="power_left"/>
//!   <instance component="SSD" subcomponent="tracker">
//!     <measured resource="cpu" by="processor_load"/>
//!     <evaluator port="match" field="error" target="0" scale="4"/>
//!     <evaluator port="match" measures="age" scale="100"/>
//!     <estimator port="estimate" field="error" cycles="2"/>
//!   </instance>
//! </robot>
//! ```

use std::ops::RangeInclusive;

use system_model::profile::Located;
use system_model::task::{
    Attachment, ContainerFigure, Estimator, Evaluator, QualityAttribute, ResourceIndex,
    ResourceSensor,
};

use super::names::{Names, bounded};
use crate::node::Node;
use crate::readers::world::quantity::within;

/// A component is good or bad in a handful of ways.
const MAX_EVALUATORS: usize = 16;
/// What is measured may be of any size and sign.
const MEASURED: RangeInclusive<f64> = -1e12..=1e12;
/// Above 0, because it divides; a nanometre or a nanosecond is the smallest that a robot measures.
const SCALE: RangeInclusive<f64> = 1e-9..=1e12;
/// A deviation needs two values; a minute at 1 kHz is the longest window that is kept.
const WINDOW: RangeInclusive<u32> = 2..=60_000;
/// As good a sample as half a second of data.
const USUAL_WINDOW: u32 = 20;
/// What needs longer to swing in is not estimated but tried.
const CYCLES: RangeInclusive<u32> = 1..=100;

/// The attachment of an instance.
pub(super) fn read(instance: &Node<'_>, resources: &Names) -> Attachment {
    let subcomponent = instance.attribute("subcomponent");
    let evaluators = bounded(instance.children("evaluator"), MAX_EVALUATORS);
    let evaluators = evaluators.iter().filter_map(evaluator);
    let evaluators = evaluators.collect();
    let estimator = instance.child("estimator").map(|node| Located {
        value: estimator(&node),
        place: node.place(),
    });
    let gauges = bounded(instance.children("measured"), resources.count().max(1));
    let gauges = gauges.iter().filter_map(|node| gauge(node, resources));
    Attachment {
        subcomponent: subcomponent.map(|value| value.as_str().to_owned()),
        evaluators,
        estimator,
        gauges: gauges.collect(),
        place: instance.place(),
    }
}

fn text(node: &Node<'_>, name: &'static str) -> Option<String> {
    let value = node.attribute(name)?;
    Some(value.as_str().to_owned())
}

/// The number of an attribute that may be left out.
fn number(node: &Node<'_>, name: &'static str, range: &RangeInclusive<f64>, usual: f64) -> f64 {
    let value = node.attribute(name);
    let number = value.and_then(|value| within(&value, range));
    number.unwrap_or(usual)
}

fn count(node: &Node<'_>, name: &'static str, range: &RangeInclusive<u32>, usual: u32) -> u32 {
    let value = node.attribute(name);
    let count = value.and_then(|value| within(&value, range));
    count.unwrap_or(usual)
}

fn evaluator(node: &Node<'_>) -> Option<Located<Evaluator>> {
    let port = node.required_attribute("port");
    let field = text(node, "field");
    let measures = node.attribute("measures");
    let measures = measures.map_or(Some(Measures::Value), |value| {
        value.choice(&[
            ("value", Measures::Value),
            ("standard_deviation", Measures::StandardDeviation),
            ("age", Measures::Age),
        ])
    });
    let window = node.attribute("window");
    let is_deviation = measures == Some(Measures::StandardDeviation);
    if let Some(window) = window.filter(|_| !is_deviation) {
        window.warning(
            "only a standard deviation has a window",
            Some("remove it, or write measures=\"standard_deviation\"".into()),
        );
    }
    let window = count(node, "window", &WINDOW, USUAL_WINDOW);
    let (target, scale) = (
        number(node, "target", &MEASURED, 0.0),
        number(node, "scale", &SCALE, 1.0),
    );
    node.finish();
    Some(Located {
        value: Evaluator {
            port: port?.as_str().to_owned(),
            field,
            attribute: match measures? {
                Measures::Value => QualityAttribute::Value,
                Measures::StandardDeviation => QualityAttribute::StandardDeviation {
                    window: usize::try_from(window).ok()?,
                },
                Measures::Age => QualityAttribute::Age,
            },
            target,
            scale,
        },
        place: node.place(),
    })
}

/// The words for what is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Measures {
    Value,
    StandardDeviation,
    Age,
}

fn estimator(node: &Node<'_>) -> Estimator {
    let (port, field) = (text(node, "port"), text(node, "field"));
    let cycles = count(node, "cycles", &CYCLES, 1);
    node.finish();
    Estimator {
        own: port.map(|port| (port, field)),
        cycles,
    }
}

fn gauge(node: &Node<'_>, resources: &Names) -> Option<(ResourceIndex, ContainerFigure)> {
    let resource = resources.required(node, "resource");
    let figure = node.required_attribute("by").and_then(|value| {
        value.choice(&[
            ("processor_load", ContainerFigure::ProcessorLoad),
            ("memory_mb", ContainerFigure::MemoryMb),
            ("overruns_per_second", ContainerFigure::OverrunsPerSecond),
        ])
    });
    node.finish();
    Some((resource?, figure?))
}

/// What ports tell of a robot's resources.
pub(super) fn sensors(robot: &Node<'_>, resources: &Names) -> Vec<Located<ResourceSensor>> {
    let nodes = bounded(robot.children("gauge"), resources.count().max(1));
    let sensors = nodes.iter().filter_map(|node| {
        let resource = resources.required(node, "resource");
        let subcomponent = node.required_attribute("subcomponent");
        let port = node.required_attribute("port");
        let field = text(node, "field");
        let scale = number(node, "scale", &SCALE, 1.0);
        node.finish();
        Some(Located {
            value: ResourceSensor {
                resource: resource?,
                subcomponent: subcomponent?.as_str().to_owned(),
                port: port?.as_str().to_owned(),
                field,
                scale,
            },
            place: node.place(),
        })
    });
    sensors.collect()
}
