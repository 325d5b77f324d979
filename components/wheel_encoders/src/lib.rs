//! Wheel encoders: wheel speeds and odometry from the encoder counters.
//!
//! Properties: `ticks_per_revolution`, `wheel_radius_m` and `track_m` of the robot.
#![forbid(unsafe_code)]

mod odometry;

use component_sdk::prelude::*;
use robot_interface::port_data::{EncoderTicks, WheelOdometry};

use odometry::{Dimensions, Odometry};

/// Ports of the encoders.
#[derive(Ports)]
pub struct WheelEncodersPorts {
    ticks: Input<EncoderTicks>,
    odometry: Output<WheelOdometry>,
}

/// The encoders.
pub struct WheelEncoders {
    ports: WheelEncodersPorts,
    dimensions: Dimensions,
    /// Registered, so that a successor knows where the robot is.
    odometry: Option<&'static mut Odometry>,
}

impl Component for WheelEncoders {
    type Ports = WheelEncodersPorts;

    fn new(ports: WheelEncodersPorts) -> Self {
        Self {
            ports,
            dimensions: Dimensions::default(),
            odometry: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        let default = Dimensions::default();
        let read = |name, value| positive(context, name, value);
        self.dimensions = Dimensions {
            ticks_per_revolution: read("ticks_per_revolution", default.ticks_per_revolution)?,
            wheel_radius_m: read("wheel_radius_m", default.wheel_radius_m)?,
            track_m: read("track_m", default.track_m)?,
        };
        if self.odometry.is_none() {
            self.odometry = Some(context.critical(Odometry::default())?);
        }
        Ok(())
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        if let Some(odometry) = &mut self.odometry {
            **odometry = Odometry::default();
        }
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        if let (Some(ticks), Some(odometry)) = (self.ports.ticks.read(), &mut self.odometry) {
            let moved = odometry.follow(&ticks, &self.dimensions);
            self.ports.odometry.write(&moved);
        }
        Ok(())
    }
}

/// A property that is divided by.
fn positive(context: &Context, name: &str, default: f64) -> Result<f64, Failure> {
    let value = context.property_or(name, default)?;
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Failure::new(
        Status::INPUT_OUT_OF_RANGE,
        format!("property '{name}' is {value}; write a number above 0"),
    ))
}

export_component!(WheelEncoders);
