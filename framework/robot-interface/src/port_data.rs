//! What travels through the ports of the reference robot's components.
//!
//! Every type is plain numbers in SI units and radians. Directions are relative to the robot: 0 is
//! straight ahead, counterclockwise (to the left) is positive. Times are those of the container's
//! clock in the cycle that made the datum. Flags are numbers, 0 or 1, because port data must be
//! valid whatever its bits are.

mod board;
mod navigation;
mod vision;

pub use board::{EncoderTicks, MotorCommand, Range, RangeReport, WheelOdometry};
pub use navigation::{GoalChoice, MotionDecision, ObstacleReport};
pub use vision::{
    DetectedObject, IMAGE_HEIGHT, IMAGE_PIXEL_BYTES, IMAGE_WIDTH, Image, TrackedTarget,
    TurnReference,
};
