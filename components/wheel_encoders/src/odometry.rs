//! From encoder ticks to wheel speeds and a pose: differential drive without slip.

use std::f64::consts::TAU;

use component_sdk::PortData;
use robot_interface::port_data::{EncoderTicks, WheelOdometry};

/// Over this time speeds are smoothed: a tick in a report of 20 ms stands for 0.03 m/s, a tenth of
/// the cruising speed.
const SMOOTHING_S: f64 = 0.06;
const SECONDS_PER_NANOSECOND: f64 = 1e-9;

/// Measures of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimensions {
    /// Encoder ticks for one turn of a wheel.
    pub ticks_per_revolution: f64,
    /// Radius of each wheel.
    pub wheel_radius_m: f64,
    /// Distance between the left and the right wheels.
    pub track_m: f64,
}

impl Default for Dimensions {
    /// The reference robot.
    fn default() -> Self {
        Self {
            ticks_per_revolution: 360.0,
            wheel_radius_m: 0.0325,
            track_m: 0.120,
        }
    }
}

/// Where the robot is, and the counters at that place.
#[derive(PortData, Debug, Clone, Copy, Default)]
#[repr(C)]
pub struct Odometry {
    pose: WheelOdometry,
    left_ticks: i32,
    right_ticks: i32,
    has_ticks: u32,
}

impl Odometry {
    /// Takes new counters. The first ones are where the robot starts, whatever they are.
    pub fn follow(&mut self, ticks: &EncoderTicks, dimensions: &Dimensions) -> WheelOdometry {
        let elapsed_s = ticks.time.saturating_sub(self.pose.time) as f64 * SECONDS_PER_NANOSECOND;
        if self.has_ticks != 0 {
            let metres_per_tick = TAU * dimensions.wheel_radius_m / dimensions.ticks_per_revolution;
            // The counters wrap, so their difference does too.
            let left_m = f64::from(ticks.left.wrapping_sub(self.left_ticks)) * metres_per_tick;
            let right_m = f64::from(ticks.right.wrapping_sub(self.right_ticks)) * metres_per_tick;
            self.turn_and_move(left_m, right_m, dimensions.track_m);
            if elapsed_s > 0.0 {
                let share = elapsed_s / (elapsed_s + SMOOTHING_S);
                self.pose.left += share * (left_m / elapsed_s - self.pose.left);
                self.pose.right += share * (right_m / elapsed_s - self.pose.right);
            }
        }
        self.pose.time = ticks.time;
        (self.left_ticks, self.right_ticks) = (ticks.left, ticks.right);
        self.has_ticks = 1;
        self.pose
    }

    /// Along the chord of the arc, whose direction is that in the middle of the turn.
    fn turn_and_move(&mut self, left_m: f64, right_m: f64, track_m: f64) {
        let turn_rad = (right_m - left_m) / track_m;
        let way_m = f64::midpoint(left_m, right_m);
        let direction_rad = self.pose.heading + turn_rad / 2.0;
        self.pose.x += way_m * direction_rad.cos();
        self.pose.y += way_m * direction_rad.sin();
        let heading_rad = self.pose.heading + turn_rad;
        self.pose.heading = heading_rad.sin().atan2(heading_rad.cos());
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const REPORT_NS: u64 = 20_000_000;

    /// The pose after so many reports in which the counters go on by these steps.
    fn driven(start: (i32, i32), left_step: i32, right_step: i32, reports: u64) -> WheelOdometry {
        let mut odometry = Odometry::default();
        let (mut left, mut right) = start;
        let mut last = WheelOdometry::default();
        for report in 0..=reports {
            let time = report * REPORT_NS;
            last = odometry.follow(&EncoderTicks { time, left, right }, &Dimensions::default());
            (left, right) = (left.wrapping_add(left_step), right.wrapping_add(right_step));
        }
        last
    }

    #[test]
    fn one_revolution_of_both_wheels_is_their_circumference() {
        let last = driven((1000, -7), 10, 10, 36);
        assert!((last.x - TAU * 0.0325).abs() < 1e-9, "{last:?}");
        assert!(last.y.abs() < 1e-9 && last.heading.abs() < 1e-9);
        let speed_m_per_s = 10.0 / 360.0 * TAU * 0.0325 / 0.02;
        assert!((last.left - speed_m_per_s).abs() < 1e-3, "{last:?}");
    }

    #[test]
    fn turning_left_is_positive_and_stays_within_a_turn() {
        // The wheels run on a circle of 0.06 m: half a turn needs 0.1885 m, 332.3 ticks.
        let last = driven((0, 0), -1, 1, 332);
        assert!((last.heading - PI).abs() < 0.01, "{last:?}");
        assert!(driven((0, 0), -1, 1, 340).heading < 0.0);
        assert!(last.x.abs() < 1e-9 && last.y.abs() < 1e-9);
    }

    #[test]
    fn a_counter_that_wraps_goes_on() {
        let last = driven((i32::MAX - 3, i32::MAX - 3), 10, 10, 36);
        assert!((last.x - TAU * 0.0325).abs() < 1e-9, "{last:?}");
    }

    #[test]
    fn two_reports_of_one_time_leave_the_speed() {
        let mut odometry = Odometry::default();
        let ticks = EncoderTicks {
            time: 1,
            left: 0,
            right: 0,
        };
        odometry.follow(&ticks, &Dimensions::default());
        let last = odometry.follow(&EncoderTicks { left: 9, ..ticks }, &Dimensions::default());
        assert!(last.left.abs() < 1e-12 && last.x > 0.0);
    }
}
