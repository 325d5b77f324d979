//! Ultrasonic sensor: one of the ranges of the motion board, without outliers.
//!
//! Property `index`: the socket of the motion board, 0 front, 1 left, 2 right, 3 rear.
#![forbid(unsafe_code)]

mod outlier_filter;

use component_sdk::prelude::*;
use robot_interface::port_data::{Range, RangeReport};
use robot_interface::serial_line::SONAR_COUNT;

use outlier_filter::OutlierFilter;

/// Ports of a sensor.
#[derive(Ports)]
pub struct UltrasonicSensorPorts {
    ranges: Input<RangeReport>,
    range: Output<Range>,
}

/// One sensor.
pub struct UltrasonicSensor {
    ports: UltrasonicSensorPorts,
    index: usize,
    filter: OutlierFilter,
}

impl Component for UltrasonicSensor {
    type Ports = UltrasonicSensorPorts;

    fn new(ports: UltrasonicSensorPorts) -> Self {
        Self {
            ports,
            index: 0,
            filter: OutlierFilter::default(),
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.index = context.property_or("index", 0)?;
        if self.index >= SONAR_COUNT {
            return Err(Failure::new(
                Status::INPUT_OUT_OF_RANGE,
                format!(
                    "property 'index' is {}; the motion board has the sockets 0 to {}",
                    self.index,
                    SONAR_COUNT - 1
                ),
            ));
        }
        Ok(())
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        self.filter = OutlierFilter::default();
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        if let Some(report) = self.ports.ranges.read() {
            self.ports.range.write(&Range {
                time: report.time,
                distance: self.filter.filter(report.distances[self.index]),
            });
        }
        Ok(())
    }
}

export_component!(UltrasonicSensor);
