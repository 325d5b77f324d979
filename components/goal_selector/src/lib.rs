//! Goal selector: hands on to the path planner the goal that a mission has chosen: what a detector
//! sees, the place where the robot started, or to stay where it is.
#![forbid(unsafe_code)]

mod way_home;

use component_sdk::prelude::*;
use robot_interface::port_data::{DetectedObject, GoalChoice, WheelOdometry};

/// Values of [`GoalChoice::goal`].
const FIRST_EYES: u32 = 1;
const SECOND_EYES: u32 = 2;
const HOME: u32 = 3;

/// Ports of the selector.
#[derive(Ports)]
pub struct GoalSelectorPorts {
    choice: Input<GoalChoice>,
    first_object: Input<DetectedObject>,
    second_object: Input<DetectedObject>,
    odometry: Input<WheelOdometry>,
    object: Output<DetectedObject>,
}

/// The selector.
pub struct GoalSelector {
    ports: GoalSelectorPorts,
}

impl Component for GoalSelector {
    type Ports = GoalSelectorPorts;

    fn new(ports: GoalSelectorPorts) -> Self {
        Self { ports }
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let (first, second) = (
            self.ports.first_object.read(),
            self.ports.second_object.read(),
        );
        let odometry = self.ports.odometry.latest();
        let goal = self.ports.choice.latest().map_or(0, |choice| choice.goal);
        let time = u64::try_from(context.now().as_nanos()).unwrap_or(u64::MAX);
        let object = match goal {
            FIRST_EYES => first,
            SECOND_EYES => second,
            HOME => odometry.map(|odometry| way_home::home(time, &odometry)),
            _ => Some(way_home::here(time)),
        };
        if let Some(object) = object {
            self.ports.object.write(&object);
        }
        Ok(())
    }
}

export_component!(GoalSelector);
