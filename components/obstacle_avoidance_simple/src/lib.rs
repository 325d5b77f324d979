//! Obstacle avoidance straight from the latest ranges, without memory of echoes.
//!
//! The secondary of the reference robot: same ports as `obstacle_avoidance`, another algorithm.
#![forbid(unsafe_code)]

mod closeness_steering;

use component_sdk::prelude::*;
use robot_interface::port_data::{ObstacleReport, Range, WheelOdometry};

use closeness_steering::{ClosenessSteering, Ranges};

/// A sensor that was not heard of for this long, fifteen reports of the board, does not answer.
const SILENCE_NS: u64 = 300_000_000;

/// Ports of both obstacle avoidances.
#[derive(Ports)]
pub struct ObstacleAvoidanceSimplePorts {
    front: Input<Range>,
    left: Input<Range>,
    right: Input<Range>,
    rear: Input<Range>,
    /// Not read: this algorithm does without. It is here so that it fits in the primary's place.
    #[port("odometry")]
    _odometry: Input<WheelOdometry>,
    obstacles: Output<ObstacleReport>,
}

/// The secondary obstacle avoidance.
pub struct ObstacleAvoidanceSimple {
    ports: ObstacleAvoidanceSimplePorts,
    steering: Option<&'static mut ClosenessSteering>,
}

impl Component for ObstacleAvoidanceSimple {
    type Ports = ObstacleAvoidanceSimplePorts;

    fn new(ports: ObstacleAvoidanceSimplePorts) -> Self {
        Self {
            ports,
            steering: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        if self.steering.is_none() {
            self.steering = Some(context.critical(ClosenessSteering::default())?);
        }
        Ok(())
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        if let Some(steering) = &mut self.steering {
            **steering = ClosenessSteering::default();
        }
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let (Some(front), Some(left), Some(right), Some(rear), Some(steering)) = (
            self.ports.front.latest(),
            self.ports.left.latest(),
            self.ports.right.latest(),
            self.ports.rear.latest(),
            &mut self.steering,
        ) else {
            return Ok(());
        };
        let time_ns = u64::try_from(context.now().as_nanos()).unwrap_or(u64::MAX);
        let fresh_m = |range: Range| match time_ns.saturating_sub(range.time) {
            0..=SILENCE_NS => range.distance,
            _ => 0.0,
        };
        let ranges = Ranges {
            front_m: fresh_m(front),
            left_m: fresh_m(left),
            right_m: fresh_m(right),
            rear_m: fresh_m(rear),
        };
        self.ports
            .obstacles
            .write(&steering.steer(time_ns, &ranges));
        Ok(())
    }
}

export_component!(ObstacleAvoidanceSimple);
