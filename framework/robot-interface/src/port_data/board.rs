//! What comes from the motion board and what goes to it.

use component_sdk::prelude::*;

use crate::serial_line::{MotionCommand, MotionType, SONAR_COUNT};

/// All four ranges as the motion board reports them.
#[derive(PortData, Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct RangeReport {
    /// When the report arrived.
    #[unit("ns")]
    pub time: u64,
    /// In the order of the board's sockets: front, left, right, rear. 0 means that the sensor does
    /// not answer.
    #[unit("m")]
    pub distances: [f64; SONAR_COUNT],
}

/// The range of one ultrasonic sensor.
#[derive(PortData, Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Range {
    /// When the report arrived from which it was taken.
    #[unit("ns")]
    pub time: u64,
    /// Distance from the sensor to the nearest thing in its cone. 0 means that the sensor does not
    /// answer; the farthest range means that nothing is in the cone.
    #[unit("m")]
    pub distance: f64,
}

/// The counters of the wheel encoders.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct EncoderTicks {
    /// When the report arrived.
    #[unit("ns")]
    pub time: u64,
    /// Left wheels, forward is up; wraps.
    #[unit("tick")]
    pub left: i32,
    /// Right wheels, forward is up; wraps.
    #[unit("tick")]
    pub right: i32,
}

/// How fast the wheels turn, and where that has brought the robot.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct WheelOdometry {
    /// When the report arrived from which it was reckoned.
    #[unit("ns")]
    pub time: u64,
    /// Speed of the left wheels' rims, forward is positive.
    #[unit("m/s")]
    pub left: f64,
    /// Speed of the right wheels' rims.
    #[unit("m/s")]
    pub right: f64,
    /// Place of the robot's centre relative to where it started, along its heading there.
    #[unit("m")]
    pub x: f64,
    /// As `x`, to the left of the heading at the start.
    #[unit("m")]
    pub y: f64,
    /// Direction relative to the one at the start, from -pi to pi.
    #[unit("rad")]
    pub heading: f64,
}

/// A command of table 4 for the motion board.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct MotorCommand {
    /// When it was decided.
    #[unit("ns")]
    pub time: u64,
    /// 0 stop, 1 forward, 2 backward, 3 turn left, 4 turn right.
    pub motion_type: u32,
    /// Mean wheel speed, not negative.
    #[unit("rpm")]
    pub rpm: i32,
    /// Difference between the wheel speeds.
    #[unit("rpm")]
    pub rpm_difference: i32,
}

impl MotorCommand {
    /// The command as it travels through ports.
    pub fn new(time_ns: u64, command: MotionCommand) -> Self {
        Self {
            time: time_ns,
            motion_type: command.motion_type as u32,
            rpm: i32::from(command.rpm),
            rpm_difference: i32::from(command.rpm_difference),
        }
    }

    /// The command as it travels over the serial line; none if a number has no meaning there.
    pub fn motion_command(self) -> Option<MotionCommand> {
        Some(MotionCommand {
            motion_type: MotionType::from_code(u8::try_from(self.motion_type).ok()?)?,
            rpm: i16::try_from(self.rpm).ok()?,
            rpm_difference: i16::try_from(self.rpm_difference).ok()?,
        })
    }
}
