//! PID controller: makes a turn rate of the angle that is left to turn.
//!
//! Properties: the gains `proportional_per_s`, `integral_per_s2` and `derivative`, and
//! `turn_rate_maximum_rad_per_s`. Where there is nothing to turn to the robot stands still.
#![forbid(unsafe_code)]

mod regulator;

use component_sdk::prelude::*;
use robot_interface::port_data::{MotionDecision, TurnReference};

use regulator::{Gains, Regulator};

/// Ports of the controller.
#[derive(Ports)]
pub struct PidControllerPorts {
    reference: Input<TurnReference>,
    motion: Output<MotionDecision>,
}

/// The controller.
pub struct PidController {
    ports: PidControllerPorts,
    regulator: Regulator,
}

impl Component for PidController {
    type Ports = PidControllerPorts;

    fn new(ports: PidControllerPorts) -> Self {
        Self {
            ports,
            regulator: Regulator::new(Gains::default()),
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        let default = Gains::default();
        let gains = Gains {
            proportional_per_s: context
                .property_or("proportional_per_s", default.proportional_per_s)?,
            integral_per_s2: context.property_or("integral_per_s2", default.integral_per_s2)?,
            derivative: context.property_or("derivative", default.derivative)?,
            output_maximum: context
                .property_or("turn_rate_maximum_rad_per_s", default.output_maximum)?,
        };
        if !gains.are_possible() {
            let message = format!("no controller has these gains, all 0 or more: {gains:?}");
            return Err(Failure::new(Status::INPUT_OUT_OF_RANGE, message));
        }
        self.regulator = Regulator::new(gains);
        Ok(())
    }

    fn on_recover(&mut self, _context: &Context) -> Outcome {
        // What was summed up before the failure belongs to another situation.
        self.regulator.forget();
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        if let Some(reference) = self.ports.reference.read() {
            let turn_rate = match reference.valid != 0 && reference.turn.is_finite() {
                true => self.regulator.regulate(reference.time, reference.turn),
                false => {
                    self.regulator.forget();
                    0.0
                }
            };
            self.ports.motion.write(&MotionDecision {
                time: reference.time,
                speed: 0.0,
                turn_rate,
            });
        }
        Ok(())
    }
}

export_component!(PidController);
