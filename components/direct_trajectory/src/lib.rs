//! Direct trajectory: turns towards a tracked target at once, and stands still while it is lost.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use robot_interface::port_data::{TrackedTarget, TurnReference};

/// Ports of the generator.
#[derive(Ports)]
pub struct DirectTrajectoryPorts {
    target: Input<TrackedTarget>,
    reference: Output<TurnReference>,
}

/// The generator.
pub struct DirectTrajectory {
    ports: DirectTrajectoryPorts,
}

impl Component for DirectTrajectory {
    type Ports = DirectTrajectoryPorts;

    fn new(ports: DirectTrajectoryPorts) -> Self {
        Self { ports }
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        if let Some(target) = self.ports.target.read() {
            let is_there = target.visible != 0 && target.bearing.is_finite();
            self.ports.reference.write(&TurnReference {
                time: target.time,
                valid: u32::from(is_there),
                turn: if is_there { target.bearing } else { 0.0 },
            });
        }
        Ok(())
    }
}

export_component!(DirectTrajectory);
