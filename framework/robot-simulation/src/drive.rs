//! Four motors on two sides, and the wheels between them and the floor.
//!
//! The two wheels of a side turn together: one driver feeds both motors. They roll without slip
//! along the body, so their speed is that of the floor under them, also when nothing drives them.

use std::f64::consts::TAU;

use system_model::world::RobotSpecification;

use crate::body_motion::{BodyForce, BodyVelocity};
use crate::fault::Side;

/// What the two motors of one side push at most: stall torque, below the traction of rubber.
const SIDE_FORCE_MAXIMUM_N: f64 = 2.5;
/// Drag of the gears and motors of one side. With [`SCRUB_N_M_S_PER_RAD`] it makes the wheels of a
/// side without power fall to a third of the other side's speed with a time constant of 0.8 s, as
/// figure 10 of Ahn et al. (2012) shows it.
const SIDE_DRAG_N_S_PER_M: f64 = 0.7;
/// Resistance of four wheels that scrub sideways while the robot turns.
const SCRUB_N_M_S_PER_RAD: f64 = 0.0045;
/// Rubber on a smooth floor.
const LATERAL_FRICTION: f64 = 0.7;
const GRAVITY_M_PER_S2: f64 = 9.81;
/// Share of the proportional gain that the integral part adds in one motor time constant: enough
/// to overcome drag, little enough not to overshoot.
const INTEGRAL_SHARE: f64 = 0.08;

/// The drive: speed regulators, motors, wheels.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    robot: RobotSpecification,
    left: WheelPair,
    right: WheelPair,
}

/// The two wheels of one side.
#[derive(Debug, Clone, Copy, Default)]
struct WheelPair {
    speed_m_per_s: f64,
    turned_rad: f64,
    integral_n: f64,
}

/// What one side is told.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SideCommand {
    pub(crate) rpm: f64,
    /// The motor driver has power.
    pub(crate) powered: bool,
}

impl Drive {
    pub(crate) fn new(robot: RobotSpecification) -> Self {
        Self {
            robot,
            left: WheelPair::default(),
            right: WheelPair::default(),
        }
    }

    /// The force on the body during the next step.
    pub(crate) fn force(
        &mut self,
        velocity: BodyVelocity,
        left: SideCommand,
        right: SideCommand,
        step_s: f64,
    ) -> BodyForce {
        let left_n = self.left.force_n(left, &self.robot, step_s);
        let right_n = self.right.force_n(right, &self.robot, step_s);
        let mass_kg = self.robot.mass_kg;
        let grip_n = LATERAL_FRICTION * mass_kg * GRAVITY_M_PER_S2;
        let stop_slide_n = -mass_kg * velocity.lateral_m_per_s / step_s;
        BodyForce {
            forward_n: left_n + right_n,
            lateral_n: stop_slide_n.clamp(-grip_n, grip_n),
            torque_n_m: (right_n - left_n) * self.robot.track_m / 2.0
                - SCRUB_N_M_S_PER_RAD * velocity.turn_rad_per_s,
        }
    }

    /// Lets the wheels follow the body after a step.
    pub(crate) fn follow(&mut self, velocity: BodyVelocity, step_s: f64) {
        let difference_m_per_s = velocity.turn_rad_per_s * self.robot.track_m / 2.0;
        let radius_m = self.robot.wheel_radius_m;
        self.left.roll(
            velocity.forward_m_per_s - difference_m_per_s,
            radius_m,
            step_s,
        );
        self.right.roll(
            velocity.forward_m_per_s + difference_m_per_s,
            radius_m,
            step_s,
        );
    }

    /// Angle by which the wheels of a side have turned since the start, forward is up.
    pub(crate) fn turned_rad(&self, side: Side) -> f64 {
        self.wheels(side).turned_rad
    }

    /// Speed of the wheels of a side.
    pub(crate) fn rpm(&self, side: Side) -> f64 {
        self.wheels(side).speed_m_per_s / self.robot.wheel_radius_m * 60.0 / TAU
    }

    fn wheels(&self, side: Side) -> &WheelPair {
        match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        }
    }
}

impl WheelPair {
    /// What this side pushes forward: a speed regulator within the force of its motors, less drag.
    fn force_n(&mut self, command: SideCommand, robot: &RobotSpecification, step_s: f64) -> f64 {
        let drag_n = SIDE_DRAG_N_S_PER_M * self.speed_m_per_s;
        if !command.powered {
            self.integral_n = 0.0;
            return -drag_n;
        }
        let maximum_rpm = robot.wheel_maximum_rpm;
        let rpm = command.rpm.clamp(-maximum_rpm, maximum_rpm);
        let wanted_m_per_s = rpm / 60.0 * TAU * robot.wheel_radius_m;
        let time_constant_s = robot.motor_time_constant_s;
        // Each side moves about half of the robot, in a straight drive and in a turn.
        let gain_n_s_per_m = robot.mass_kg / 2.0 / time_constant_s;
        let proportional_n = gain_n_s_per_m * (wanted_m_per_s - self.speed_m_per_s);
        let integral_step_n = INTEGRAL_SHARE * proportional_n * step_s / time_constant_s;
        self.integral_n =
            (self.integral_n + integral_step_n).clamp(-SIDE_FORCE_MAXIMUM_N, SIDE_FORCE_MAXIMUM_N);
        let motor_n = proportional_n + self.integral_n;
        motor_n.clamp(-SIDE_FORCE_MAXIMUM_N, SIDE_FORCE_MAXIMUM_N) - drag_n
    }

    fn roll(&mut self, speed_m_per_s: f64, radius_m: f64, step_s: f64) {
        self.speed_m_per_s = speed_m_per_s;
        self.turned_rad += speed_m_per_s * step_s / radius_m;
    }
}
