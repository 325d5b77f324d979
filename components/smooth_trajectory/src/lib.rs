//! Smooth trajectory: turns towards a tracked target without haste, and stands still while it is
//! lost.
//!
//! Property `time_constant_s`: in this time the robot is asked to turn to within 37 % of where the
//! target appears.
#![forbid(unsafe_code)]

mod low_pass;

use component_sdk::prelude::*;
use robot_interface::port_data::{TrackedTarget, TurnReference};

use low_pass::LowPass;

/// Three pictures of a camera that takes ten a second.
const TIME_CONSTANT_S: f64 = 0.3;

/// Ports of the generator.
#[derive(Ports)]
pub struct SmoothTrajectoryPorts {
    target: Input<TrackedTarget>,
    reference: Output<TurnReference>,
}

/// The generator.
pub struct SmoothTrajectory {
    ports: SmoothTrajectoryPorts,
    turn: LowPass,
}

impl Component for SmoothTrajectory {
    type Ports = SmoothTrajectoryPorts;

    fn new(ports: SmoothTrajectoryPorts) -> Self {
        Self {
            ports,
            turn: LowPass::new(TIME_CONSTANT_S),
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        let time_constant_s = context.property_or("time_constant_s", TIME_CONSTANT_S)?;
        if !(time_constant_s >= 0.0 && time_constant_s.is_finite()) {
            let message = format!("time_constant_s is 0 or more, not {time_constant_s}");
            return Err(Failure::new(Status::INPUT_OUT_OF_RANGE, message));
        }
        self.turn = LowPass::new(time_constant_s);
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        if let Some(target) = self.ports.target.read() {
            let is_there = target.visible != 0 && target.bearing.is_finite();
            let turn = is_there.then(|| self.turn.follow(target.time, target.bearing));
            if turn.is_none() {
                self.turn.forget();
            }
            self.ports.reference.write(&TurnReference {
                time: target.time,
                valid: u32::from(is_there),
                turn: turn.unwrap_or_default(),
            });
        }
        Ok(())
    }
}

export_component!(SmoothTrajectory);
