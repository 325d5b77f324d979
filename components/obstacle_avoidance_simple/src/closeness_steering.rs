//! Steering by closeness: each sensor pushes the robot to the other side, the nearer the stronger.

use component_sdk::PortData;
use robot_interface::port_data::ObstacleReport;

/// Echoes farther than this do not matter.
const NEAR_M: f64 = 0.5;
/// Turn rate for a thing at the very sensor, to the side.
const SIDE_GAIN_RAD_PER_S: f64 = 2.8;
/// Turn rate for a thing at the very sensor, in front.
const FRONT_GAIN_RAD_PER_S: f64 = 3.4;
/// The robot stands when something is at 3/8 of [`NEAR_M`] in front: 0.19 m.
const FRONT_BRAKE: f64 = 1.6;
/// Whatever is near halves the speed at most.
const NEAR_BRAKE: f64 = 0.5;
/// With a sensor that does not answer the robot goes on slowly.
const BLIND_SPEED_SHARE: f64 = 0.3;
/// What a sensor at its farthest reads.
const FARTHEST_M: f64 = 3.0;
/// From the robot's centre to the sensors in front and behind.
const SENSOR_RADIUS_M: f64 = 0.11;
/// Directions of the sensors.
const SENSOR_HEADINGS_DEG: [f64; 4] = [0.0, 40.0, -40.0, 180.0];

/// The latest ranges; 0 where the sensor does not answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranges {
    /// Of the sensor in front.
    pub front_m: f64,
    /// Of the sensor at the left front corner.
    pub left_m: f64,
    /// Of the sensor at the right front corner.
    pub right_m: f64,
    /// Of the sensor behind.
    pub rear_m: f64,
}

/// What must be remembered: which way the robot evades the thing in front.
#[derive(PortData, Debug, Clone, Copy, Default)]
#[repr(C)]
pub struct ClosenessSteering {
    /// 1 to the left, -1 to the right, 0 while nothing is in front. Kept until the way is free: a
    /// robot that changes its mind in front of an obstacle gets nowhere.
    evasion_side: f64,
}

impl ClosenessSteering {
    /// What the ranges mean for the way. A sensor that does not answer has no echo.
    pub fn steer(&mut self, time_ns: u64, ranges: &Ranges) -> ObstacleReport {
        let ahead_m = [ranges.front_m, ranges.left_m, ranges.right_m];
        let [front, left, right] = ahead_m.map(closeness);
        if front <= 0.0 {
            self.evasion_side = 0.0;
        } else if self.evasion_side == 0.0 {
            self.evasion_side = if left < right { 1.0 } else { -1.0 };
        }
        let urgency = front.max(left).max(right);
        let brake = (1.0 - FRONT_BRAKE * front).max(0.0);
        let is_blind = ahead_m.iter().any(|range_m| *range_m <= 0.0);
        let speed_limit = if is_blind { BLIND_SPEED_SHARE } else { 1.0 };
        let (nearest_m, nearest_bearing_rad) = nearest(ranges);
        ObstacleReport {
            time: time_ns,
            nearest_distance: nearest_m,
            nearest_bearing: nearest_bearing_rad,
            evasive_turn_rate: SIDE_GAIN_RAD_PER_S * (right - left)
                + FRONT_GAIN_RAD_PER_S * front * self.evasion_side,
            urgency,
            speed_share: (brake * (1.0 - NEAR_BRAKE * urgency)).min(speed_limit),
        }
    }
}

/// 0 from [`NEAR_M`] on, 1 at the sensor; 0 for a sensor that does not answer.
fn closeness(range_m: f64) -> f64 {
    if range_m <= 0.0 {
        return 0.0;
    }
    ((NEAR_M - range_m) / NEAR_M).max(0.0)
}

/// Distance and direction of the nearest echo.
fn nearest(ranges: &Ranges) -> (f64, f64) {
    let ranges_m = [ranges.front_m, ranges.left_m, ranges.right_m, ranges.rear_m];
    let echoes = ranges_m.into_iter().zip(SENSOR_HEADINGS_DEG);
    let nearest = echoes
        .filter(|(range_m, _)| *range_m > 0.0 && *range_m < FARTHEST_M)
        .min_by(|(one_m, _), (other_m, _)| one_m.total_cmp(other_m));
    nearest.map_or((FARTHEST_M, 0.0), |(range_m, heading_deg)| {
        (range_m + SENSOR_RADIUS_M, heading_deg.to_radians())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: Ranges = Ranges {
        front_m: 3.0,
        left_m: 3.0,
        right_m: 3.0,
        rear_m: 3.0,
    };

    fn steer(ranges: Ranges) -> ObstacleReport {
        ClosenessSteering::default().steer(7, &ranges)
    }

    #[test]
    fn a_free_way_is_left_to_the_goal() {
        let report = steer(FREE);
        assert_eq!((report.urgency, report.evasive_turn_rate), (0.0, 0.0));
        assert_eq!(
            (report.speed_share, report.nearest_distance),
            (1.0, FARTHEST_M)
        );
    }

    #[test]
    fn a_thing_at_a_side_pushes_to_the_other() {
        let report = steer(Ranges {
            left_m: 0.25,
            ..FREE
        });
        assert!(report.evasive_turn_rate < 0.0 && report.speed_share > 0.5);
        assert!((report.nearest_bearing - 40.0_f64.to_radians()).abs() < 1e-12);
        assert!(
            steer(Ranges {
                right_m: 0.25,
                ..FREE
            })
            .evasive_turn_rate
                > 0.0
        );
    }

    #[test]
    fn the_side_of_evasion_is_kept_until_the_way_is_free() {
        let mut steering = ClosenessSteering::default();
        let ahead = Ranges {
            front_m: 0.3,
            ..FREE
        };
        let first = steering.steer(
            0,
            &Ranges {
                right_m: 0.45,
                ..ahead
            },
        );
        let second = steering.steer(
            1,
            &Ranges {
                left_m: 0.45,
                ..ahead
            },
        );
        assert!(first.evasive_turn_rate > 0.0 && second.evasive_turn_rate > 0.0);
        steering.steer(2, &FREE);
        let third = steering.steer(
            3,
            &Ranges {
                left_m: 0.45,
                ..ahead
            },
        );
        assert!(third.evasive_turn_rate < 0.0);
    }

    #[test]
    fn the_robot_stands_before_it_touches() {
        let report = steer(Ranges {
            front_m: 0.15,
            ..FREE
        });
        assert_eq!(report.speed_share, 0.0);
    }

    #[test]
    fn a_blind_sensor_slows_down_and_is_no_echo() {
        let report = steer(Ranges {
            left_m: 0.0,
            ..FREE
        });
        assert_eq!(report.speed_share, BLIND_SPEED_SHARE);
        assert_eq!((report.urgency, report.evasive_turn_rate), (0.0, 0.0));
    }
}
