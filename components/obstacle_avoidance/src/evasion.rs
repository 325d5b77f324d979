//! From the free ways to a turn and a speed.

use std::f64::consts::FRAC_PI_2;

use component_sdk::PortData;
use robot_interface::port_data::{ObstacleReport, Range, WheelOdometry};
use robot_interface::serial_line::SONAR_COUNT;

use crate::echo_map::{EchoMap, REAR, Sensor, Sighting};
use crate::polar_histogram::{PolarHistogram, WINDOW_M};

/// Largest turn that still counts as a way past an obstacle; beyond it the robot turns on the spot.
const LARGEST_TURN_RAD: f64 = 2.1;
/// The other side must be this much better to change the side of evasion.
const CHANGE_OF_SIDE_RAD: f64 = 0.7;
const TURN_GAIN_PER_S: f64 = 2.5;
const TURN_RATE_MAXIMUM_RAD_PER_S: f64 = 1.8;
/// Turning on the spot when there is no way.
const TURN_RATE_ON_THE_SPOT_RAD_PER_S: f64 = 1.0;
/// At this free way the evasion alone decides.
const URGENT_M: f64 = 0.35;
/// Only what stands in the strip that the robot sweeps slows it down: half its width, and 7 cm. It
/// is narrower than the way it looks for, or the robot would creep along every obstacle.
const HALF_STRIP_M: f64 = 0.14;
/// With an echo in the strip so near to its centre the robot stands: 0.11 m before its front.
const STANDSTILL_M: f64 = 0.22;
/// An echo in the strip at this distance does not slow it down yet.
const FULL_SPEED_M: f64 = 0.65;
/// Echoes beside the robot nearer than this to its centre push it away.
const SIDE_NEAR_M: f64 = 0.32;
/// What is pushed away at the robot's own outline.
const SIDE_GAIN_RAD_PER_S: f64 = 2.4;
/// From the centre of the robot to its corners: an echo cannot be nearer.
const OUTLINE_M: f64 = 0.126;
/// Beside an obstacle the robot slows down to this share.
const SIDE_SPEED_SHARE: f64 = 0.5;
/// With a blind sensor the robot goes on slowly.
const BLIND_SPEED_SHARE: f64 = 0.3;
/// A sensor that was not heard of for this long, fifteen reports of the board, is blind.
const SILENCE_NS: u64 = 300_000_000;
/// What a sensor at its farthest reads.
const FARTHEST_M: f64 = 3.0;

/// What is known of one sensor.
#[derive(PortData, Debug, Clone, Copy, Default)]
#[repr(C)]
struct SensorState {
    /// Whether it ever sent a range.
    is_known: u32,
    /// Whether the last range said that it does not answer.
    is_mute: u32,
    /// When it was heard of last.
    heard_at: u64,
}

/// What must be remembered.
#[derive(PortData, Debug, Clone, Copy)]
#[repr(C)]
pub struct Evasion {
    map: EchoMap,
    /// 1 to the left, -1 to the right, 0 while the way ahead is free.
    side: f64,
    sensors: [SensorState; SONAR_COUNT],
}

/// What the way ahead asks for.
struct Way {
    turn_rate_rad_per_s: f64,
    urgency: f64,
    speed_share: f64,
}

impl SensorState {
    fn is_blind(&self, time_ns: u64) -> bool {
        self.is_mute != 0 || time_ns.saturating_sub(self.heard_at) > SILENCE_NS
    }
}

impl Evasion {
    /// Nothing known yet.
    pub fn new() -> Self {
        Self {
            map: EchoMap::new(),
            side: 0.0,
            sensors: [SensorState::default(); SONAR_COUNT],
        }
    }

    /// Takes a range; that of a sensor which does not answer is no echo.
    pub fn take_range(&mut self, sensor: &Sensor, range: &Range, pose: &WheelOdometry) {
        let is_mute = range.distance <= 0.0;
        self.sensors[sensor.index] = SensorState {
            is_known: 1,
            is_mute: u32::from(is_mute),
            heard_at: range.time,
        };
        if !is_mute {
            self.map.take_range(sensor, range.distance, pose);
        }
    }

    /// What the echoes mean for the way; none before every sensor was heard of.
    pub fn report(&mut self, time_ns: u64, pose: &WheelOdometry) -> Option<ObstacleReport> {
        if self.sensors.iter().any(|sensor| sensor.is_known == 0) {
            return None;
        }
        let nearest = self
            .map
            .sightings(pose)
            .min_by(|one, other| one.distance_m.total_cmp(&other.distance_m));
        let ahead = self.way_ahead(
            &PolarHistogram::new(self.map.sightings(pose)),
            self.strip_m(pose),
        );
        let beside = self.way_beside(pose);
        let is_blind = self.sensors[..REAR.index]
            .iter()
            .any(|sensor| sensor.is_blind(time_ns));
        let speed_limit = if is_blind { BLIND_SPEED_SHARE } else { 1.0 };
        Some(ObstacleReport {
            time: time_ns,
            nearest_distance: nearest.map_or(FARTHEST_M, |echo| echo.distance_m),
            nearest_bearing: nearest.map_or(0.0, |echo| echo.bearing_rad),
            evasive_turn_rate: ahead.turn_rate_rad_per_s + beside.turn_rate_rad_per_s,
            urgency: ahead.urgency.max(beside.urgency),
            speed_share: ahead.speed_share.min(beside.speed_share).min(speed_limit),
        })
    }

    /// Into the nearest free direction, on the side that was chosen before if that is nearly as
    /// good.
    fn way_ahead(&mut self, histogram: &PolarHistogram, strip_m: f64) -> Way {
        let ahead_m = histogram.ahead_m();
        if ahead_m >= WINDOW_M {
            self.side = 0.0;
            return Way {
                turn_rate_rad_per_s: 0.0,
                urgency: 0.0,
                speed_share: 1.0,
            };
        }
        let turn_rad = |side| histogram.free_turn_rad(side, LARGEST_TURN_RAD);
        let (left, right) = (turn_rad(1.0), turn_rad(-1.0));
        self.side = self.chosen_side(left, right);
        let turn = if self.side > 0.0 { left } else { right };
        let turn_rate_rad_per_s = turn.map_or(TURN_RATE_ON_THE_SPOT_RAD_PER_S, |turn_rad| {
            (TURN_GAIN_PER_S * turn_rad).min(TURN_RATE_MAXIMUM_RAD_PER_S)
        });
        let share = (strip_m - STANDSTILL_M) / (FULL_SPEED_M - STANDSTILL_M);
        Way {
            turn_rate_rad_per_s: self.side * turn_rate_rad_per_s,
            urgency: ((WINDOW_M - ahead_m) / (WINDOW_M - URGENT_M)).clamp(0.0, 1.0),
            speed_share: turn.map_or(0.0, |_| share.clamp(0.0, 1.0)),
        }
    }

    /// How far the strip that the robot sweeps straight ahead is free.
    fn strip_m(&self, pose: &WheelOdometry) -> f64 {
        let ahead_m = |echo: Sighting| {
            let (aside, along) = echo.bearing_rad.sin_cos();
            let is_in_strip = along > 0.0 && (echo.distance_m * aside).abs() < HALF_STRIP_M;
            is_in_strip.then_some(echo.distance_m * along)
        };
        let echoes_m = self.map.sightings(pose).filter_map(ahead_m);
        echoes_m.fold(FULL_SPEED_M, f64::min)
    }

    fn chosen_side(&self, left: Option<f64>, right: Option<f64>) -> f64 {
        let [left_rad, right_rad] = [left, right].map(|turn| turn.unwrap_or(f64::MAX));
        if self.side > 0.0 && left_rad <= right_rad + CHANGE_OF_SIDE_RAD {
            return 1.0;
        }
        if self.side < 0.0 && right_rad <= left_rad + CHANGE_OF_SIDE_RAD {
            return -1.0;
        }
        if left_rad <= right_rad { 1.0 } else { -1.0 }
    }

    /// Away from what is beside the robot, in front of its rear axle.
    fn way_beside(&self, pose: &WheelOdometry) -> Way {
        let is_beside = |echo: &Sighting| echo.bearing_rad.abs() < FRAC_PI_2;
        let nearness = |echo: Sighting| {
            let nearness = (SIDE_NEAR_M - echo.distance_m) / (SIDE_NEAR_M - OUTLINE_M);
            (nearness.clamp(0.0, 1.0), echo.bearing_rad.signum())
        };
        let (nearness, side) = self
            .map
            .sightings(pose)
            .filter(is_beside)
            .map(nearness)
            .fold(
                (0.0, 0.0),
                |one, other| if other.0 > one.0 { other } else { one },
            );
        Way {
            turn_rate_rad_per_s: -side * nearness * SIDE_GAIN_RAD_PER_S,
            urgency: nearness,
            speed_share: 1.0 - (1.0 - SIDE_SPEED_SHARE) * nearness,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::echo_map::{FRONT, LEFT, RIGHT};

    const HERE: WheelOdometry = WheelOdometry {
        time: 1,
        left: 0.0,
        right: 0.0,
        x: 0.0,
        y: 0.0,
        heading: 0.0,
    };

    fn evasion(ranges_m: [f64; 4]) -> Evasion {
        let mut evasion = Evasion::new();
        for (sensor, distance) in [FRONT, LEFT, RIGHT, REAR].iter().zip(ranges_m) {
            evasion.take_range(sensor, &Range { time: 1, distance }, &HERE);
        }
        evasion
    }

    fn report(ranges_m: [f64; 4]) -> ObstacleReport {
        evasion(ranges_m)
            .report(1, &HERE)
            .expect("all sensors known")
    }

    #[test]
    fn nothing_is_said_before_all_sensors_are_known() {
        assert!(Evasion::new().report(1, &HERE).is_none());
    }

    #[test]
    fn a_free_way_is_left_to_the_goal() {
        let report = report([3.0; 4]);
        assert_eq!((report.urgency, report.evasive_turn_rate), (0.0, 0.0));
        assert_eq!(
            (report.speed_share, report.nearest_distance),
            (1.0, FARTHEST_M)
        );
    }

    #[test]
    fn the_way_past_an_obstacle_leads_where_there_is_more_room() {
        let right = report([0.3, 0.3, 3.0, 3.0]);
        assert!(
            right.evasive_turn_rate < 0.0 && right.urgency > 0.5,
            "{right:?}"
        );
        let left = report([0.3, 3.0, 0.3, 3.0]);
        assert!(
            left.evasive_turn_rate > 0.0 && left.speed_share < 0.7,
            "{left:?}"
        );
    }

    #[test]
    fn the_chosen_side_is_kept() {
        let mut evasion = evasion([0.3, 0.5, 3.0, 3.0]);
        assert!(evasion.report(1, &HERE).expect("known").evasive_turn_rate < 0.0);
        let range = Range {
            time: 1,
            distance: 3.0,
        };
        evasion.take_range(&LEFT, &range, &HERE);
        assert!(evasion.report(1, &HERE).expect("known").evasive_turn_rate < 0.0);
    }

    #[test]
    fn the_robot_stands_before_it_touches() {
        assert_eq!(report([0.10, 3.0, 3.0, 3.0]).speed_share, 0.0);
    }

    #[test]
    fn a_blind_sensor_slows_down_and_is_no_echo() {
        let report = report([0.0, 3.0, 3.0, 3.0]);
        assert_eq!(report.speed_share, BLIND_SPEED_SHARE);
        assert_eq!(report.nearest_distance, FARTHEST_M);
    }

    #[test]
    fn a_sensor_that_fell_silent_is_blind() {
        let report = evasion([3.0; 4]).report(SILENCE_NS + 2, &HERE);
        assert_eq!(report.expect("known").speed_share, BLIND_SPEED_SHARE);
    }
}
