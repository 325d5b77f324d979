//! Faults of the robot's hardware that a test or a demonstration switches on and off.

use serde::{Deserialize, Serialize};
use system_model::world::SONAR_COUNT;

/// Left or right side of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

/// A fault of the hardware. As JSON: `{"unplug_sonar":0}`, `{"motor_driver_off":"left"}`,
/// `{"encoder_dead":"right"}`, `{"camera_smoke":0.8}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// The ultrasonic sensor with this index does not answer: its range reads 0. An index for
    /// which the board has no socket changes nothing.
    UnplugSonar(usize),
    /// The driver of the motors of one side has no power; its wheels are dragged along.
    MotorDriverOff(Side),
    /// The encoder of one side counts no more.
    EncoderDead(Side),
    /// Smoke in front of the lens: 0 is clear, 1 is nothing but grey.
    CameraSmoke(f64),
}

/// The faults that are present.
#[derive(Debug, Clone, Default)]
pub(crate) struct Faults {
    unplugged_sonars: [bool; SONAR_COUNT],
    motor_drivers_off: [bool; 2],
    encoders_dead: [bool; 2],
    smoke_density: f64,
}

impl Faults {
    pub(crate) fn set(&mut self, fault: Fault) {
        self.apply(fault, true);
    }

    pub(crate) fn clear(&mut self, fault: Fault) {
        self.apply(fault, false);
    }

    fn apply(&mut self, fault: Fault, present: bool) {
        match fault {
            Fault::UnplugSonar(index) => {
                if let Some(unplugged) = self.unplugged_sonars.get_mut(index) {
                    *unplugged = present;
                }
            }
            Fault::MotorDriverOff(side) => self.motor_drivers_off[side as usize] = present,
            Fault::EncoderDead(side) => self.encoders_dead[side as usize] = present,
            Fault::CameraSmoke(density) => {
                self.smoke_density = if present {
                    density.clamp(0.0, 1.0)
                } else {
                    0.0
                };
            }
        }
    }

    pub(crate) fn sonar_answers(&self, index: usize) -> bool {
        !self.unplugged_sonars[index]
    }

    pub(crate) fn motor_driver_on(&self, side: Side) -> bool {
        !self.motor_drivers_off[side as usize]
    }

    pub(crate) fn encoder_counts(&self, side: Side) -> bool {
        !self.encoders_dead[side as usize]
    }

    /// 0 to 1.
    pub(crate) fn smoke_density(&self) -> f64 {
        self.smoke_density
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_have_names_that_people_can_write() {
        let cases = [
            (Fault::UnplugSonar(0), r#"{"unplug_sonar":0}"#),
            (
                Fault::MotorDriverOff(Side::Left),
                r#"{"motor_driver_off":"left"}"#,
            ),
            (
                Fault::EncoderDead(Side::Right),
                r#"{"encoder_dead":"right"}"#,
            ),
            (Fault::CameraSmoke(0.8), r#"{"camera_smoke":0.8}"#),
        ];
        for (fault, name) in cases {
            assert_eq!(serde_json::to_string(&fault).expect("JSON"), name);
            assert_eq!(serde_json::from_str::<Fault>(name).expect("a fault"), fault);
        }
    }
}
