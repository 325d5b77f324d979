//! From speed and turn rate to wheel speeds.

use std::f64::consts::TAU;

use component_sdk::prelude::*;

use crate::port_data::MotionDecision;
use crate::serial_line::MotionCommand;

/// Measures of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferentialDrive {
    /// Radius of each wheel.
    pub wheel_radius_m: f64,
    /// Distance between the left and the right wheels.
    pub track_m: f64,
    /// Fastest turn of a wheel.
    pub wheel_maximum_rpm: f64,
}

impl Default for DifferentialDrive {
    /// The reference robot.
    fn default() -> Self {
        Self {
            wheel_radius_m: 0.0325,
            track_m: 0.120,
            wheel_maximum_rpm: 100.0,
        }
    }
}

impl DifferentialDrive {
    /// The measures in a component's properties, called like the fields; those of the reference robot
    /// where there is none.
    ///
    /// # Errors
    /// If a property is no number, or no robot has these measures.
    pub fn of_properties(context: &Context) -> Result<Self, Failure> {
        let default = Self::default();
        let drive = Self {
            wheel_radius_m: context.property_or("wheel_radius_m", default.wheel_radius_m)?,
            track_m: context.property_or("track_m", default.track_m)?,
            wheel_maximum_rpm: context
                .property_or("wheel_maximum_rpm", default.wheel_maximum_rpm)?,
        };
        if !drive.is_possible() {
            let message = format!("no robot has these measures, all above 0: {drive:?}");
            return Err(Failure::new(Status::INPUT_OUT_OF_RANGE, message));
        }
        Ok(drive)
    }

    /// Whether a robot can have these measures.
    fn is_possible(&self) -> bool {
        [self.wheel_radius_m, self.track_m, self.wheel_maximum_rpm]
            .iter()
            .all(|measure| *measure > 0.0 && measure.is_finite())
    }

    /// The command that moves the robot as decided. What is faster than the wheels turn is slowed
    /// down without changing the turn, for a turn is what avoids a collision; a decision that is no
    /// number stops the robot.
    pub fn command(&self, decision: &MotionDecision) -> MotionCommand {
        if !decision.speed.is_finite() || !decision.turn_rate.is_finite() {
            return MotionCommand::stop();
        }
        let maximum = self.wheel_maximum_rpm;
        let turn_rpm = self.rpm(decision.turn_rate * self.track_m / 2.0);
        let turn_rpm = turn_rpm.clamp(-maximum, maximum);
        let room_rpm = maximum - turn_rpm.abs();
        let speed_rpm = self.rpm(decision.speed).clamp(-room_rpm, room_rpm);
        MotionCommand::from_wheel_rpm(speed_rpm - turn_rpm, speed_rpm + turn_rpm)
    }

    fn rpm(&self, rim_speed_m_per_s: f64) -> f64 {
        rim_speed_m_per_s / self.wheel_radius_m * 60.0 / TAU
    }
}

#[cfg(test)]
mod tests {
    use crate::serial_line::MotionType;

    use super::*;

    fn command(speed: f64, turn_rate: f64) -> MotionCommand {
        let decision = MotionDecision {
            time: 0,
            speed,
            turn_rate,
        };
        DifferentialDrive::default().command(&decision)
    }

    #[test]
    fn every_motion_of_table_4() {
        let types = [
            (0.0, 0.0, MotionType::Stop),
            (0.2, 0.0, MotionType::Forward),
            (-0.2, 0.0, MotionType::Backward),
            (0.0, 1.0, MotionType::TurnLeft),
            (0.0, -1.0, MotionType::TurnRight),
        ];
        for (speed, turn_rate, expected) in types {
            assert_eq!(command(speed, turn_rate).motion_type, expected);
        }
        // 0.1702 m/s at the rim of a wheel of 65 mm.
        assert_eq!(command(0.170_170, 0.0).wheel_rpm(), (50.0, 50.0));
    }

    #[test]
    fn the_turn_is_kept_when_the_wheels_cannot_follow() {
        let (left, right) = command(10.0, 1.0).wheel_rpm();
        assert!(left.max(right) <= 100.5, "{left} {right}");
        let slow = command(0.0, 1.0).wheel_rpm();
        assert!(((right - left) - (slow.1 - slow.0)).abs() <= 1.0);
        let (left, right) = command(0.3, -100.0).wheel_rpm();
        assert_eq!((left, right), (100.0, -100.0));
    }

    #[test]
    fn what_is_no_number_is_a_stop() {
        assert_eq!(command(f64::NAN, 0.0), MotionCommand::stop());
        assert_eq!(command(0.1, f64::INFINITY), MotionCommand::stop());
    }
}
