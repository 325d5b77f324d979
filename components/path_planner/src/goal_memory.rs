//! Where the target was seen last, in the coordinates of the odometry.

use component_sdk::PortData;
use robot_interface::port_data::{DetectedObject, WheelOdometry};

/// From the robot's centre to its camera.
const CAMERA_X_M: f64 = 0.09;
/// Past an obstacle of the reference arena the robot needs less; what was not seen for longer may
/// be somewhere else.
const MEMORY_NS: u64 = 5_000_000_000;

/// The target's place; time 0 means that it was never seen.
#[derive(PortData, Debug, Clone, Copy, Default)]
#[repr(C)]
pub struct GoalMemory {
    x: f64,
    y: f64,
    seen_at: u64,
}

/// The target as seen from the robot's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// To the target's middle.
    pub distance_m: f64,
    /// From straight ahead, counterclockwise.
    pub bearing_rad: f64,
}

impl GoalMemory {
    /// Takes a sighting from this pose.
    pub fn see(&mut self, time_ns: u64, object: &DetectedObject, pose: &WheelOdometry) {
        let direction_rad = pose.heading + object.bearing;
        self.x = pose.x + CAMERA_X_M * pose.heading.cos() + object.distance * direction_rad.cos();
        self.y = pose.y + CAMERA_X_M * pose.heading.sin() + object.distance * direction_rad.sin();
        self.seen_at = time_ns.max(1);
    }

    /// Where the target is from this pose; none if it was never seen, or not for a long time.
    pub fn goal(&self, time_ns: u64, pose: &WheelOdometry) -> Option<Goal> {
        if self.seen_at == 0 || time_ns.saturating_sub(self.seen_at) > MEMORY_NS {
            return None;
        }
        let (along, aside) = (self.x - pose.x, self.y - pose.y);
        let bearing_rad = aside.atan2(along) - pose.heading;
        Some(Goal {
            distance_m: along.hypot(aside),
            bearing_rad: bearing_rad.sin().atan2(bearing_rad.cos()),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn the_target_stays_where_it_is_while_the_robot_turns() {
        let mut memory = GoalMemory::default();
        let mut pose = WheelOdometry::default();
        assert_eq!(memory.goal(0, &pose), None);
        let object = DetectedObject {
            visible: 1,
            distance: 2.0,
            ..DetectedObject::default()
        };
        memory.see(0, &object, &pose);
        pose.heading = FRAC_PI_2;
        let goal = memory.goal(1, &pose).expect("seen");
        assert!((goal.distance_m - 2.09).abs() < 1e-9);
        assert!((goal.bearing_rad + FRAC_PI_2).abs() < 1e-9);
        assert_eq!(memory.goal(MEMORY_NS + 2, &pose), None);
    }
}
