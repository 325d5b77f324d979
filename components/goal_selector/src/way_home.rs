//! Goals that no camera sees.

use robot_interface::port_data::{DetectedObject, WheelOdometry};

/// From the robot's centre to its camera, from which goals are measured.
const CAMERA_X_M: f64 = 0.09;

/// The place where the robot started, as if it were seen.
pub fn home(time: u64, pose: &WheelOdometry) -> DetectedObject {
    let (sine, cosine) = pose.heading.sin_cos();
    let (along, aside) = (
        -(pose.x * cosine + pose.y * sine) - CAMERA_X_M,
        pose.x * sine - pose.y * cosine,
    );
    DetectedObject {
        time,
        visible: 1,
        bearing: aside.atan2(along),
        distance: along.hypot(aside),
        ..DetectedObject::default()
    }
}

/// The place where the robot is: it stands.
pub fn here(time: u64) -> DetectedObject {
    DetectedObject {
        time,
        visible: 1,
        ..DetectedObject::default()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn home_is_where_the_robot_started() {
        for (x, y, heading, bearing, distance) in [
            (2.0, 0.0, 0.0, PI, 2.09),
            (2.0, 0.0, PI, 0.0, 1.91),
            (0.0, 1.0, -FRAC_PI_2, 0.0, 0.91),
            (0.0, -1.0, -FRAC_PI_2, PI, 1.09),
        ] {
            let pose = WheelOdometry {
                x,
                y,
                heading,
                ..WheelOdometry::default()
            };
            let seen = home(0, &pose);
            let off = (seen.bearing - bearing).sin().abs();
            assert!(off < 1e-9, "{pose:?}: {seen:?}");
            assert!(
                (seen.distance - distance).abs() < 1e-9,
                "{pose:?}: {seen:?}"
            );
        }
    }
}
