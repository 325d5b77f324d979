//! Obstacle avoidance by a polar histogram over remembered echoes.
//!
//! The primary of the reference robot. It remembers what the sonars have seen while the robot moves
//! on, so that it does not turn into what is beside it, and steers into the nearest free direction.
#![forbid(unsafe_code)]

mod echo_map;
mod evasion;
mod polar_histogram;

use component_sdk::prelude::*;
use robot_interface::port_data::{ObstacleReport, Range, WheelOdometry};

use echo_map::{FRONT, LEFT, REAR, RIGHT};
use evasion::Evasion;

/// Without odometry for this long, fifteen reports of the board, the map is worth nothing: nothing
/// is reported, and the planner stops the robot.
const ODOMETRY_SILENCE_NS: u64 = 300_000_000;

/// Ports of both obstacle avoidances.
#[derive(Ports)]
pub struct ObstacleAvoidancePorts {
    front: Input<Range>,
    left: Input<Range>,
    right: Input<Range>,
    rear: Input<Range>,
    odometry: Input<WheelOdometry>,
    obstacles: Output<ObstacleReport>,
}

/// The primary obstacle avoidance.
pub struct ObstacleAvoidance {
    ports: ObstacleAvoidancePorts,
    /// Registered, so that a successor knows what is around it.
    evasion: Option<&'static mut Evasion>,
}

impl Component for ObstacleAvoidance {
    type Ports = ObstacleAvoidancePorts;

    fn new(ports: ObstacleAvoidancePorts) -> Self {
        Self {
            ports,
            evasion: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        if self.evasion.is_none() {
            self.evasion = Some(context.critical(Evasion::new())?);
        }
        Ok(())
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        if let Some(evasion) = &mut self.evasion {
            **evasion = Evasion::new();
        }
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let (Some(odometry), Some(evasion)) = (self.ports.odometry.latest(), &mut self.evasion)
        else {
            return Ok(());
        };
        for (sensor, input) in [
            (FRONT, &mut self.ports.front),
            (LEFT, &mut self.ports.left),
            (RIGHT, &mut self.ports.right),
            (REAR, &mut self.ports.rear),
        ] {
            if let Some(range) = input.read() {
                evasion.take_range(&sensor, &range, &odometry);
            }
        }
        let time_ns = u64::try_from(context.now().as_nanos()).unwrap_or(u64::MAX);
        if time_ns.saturating_sub(odometry.time) > ODOMETRY_SILENCE_NS {
            return Ok(());
        }
        if let Some(report) = evasion.report(time_ns, &odometry) {
            self.ports.obstacles.write(&report);
        }
        Ok(())
    }
}

export_component!(ObstacleAvoidance);
