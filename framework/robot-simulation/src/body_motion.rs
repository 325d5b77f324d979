//! How the body of the robot moves and what pushes it, in its own directions.

/// Velocity of the centre of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct BodyVelocity {
    pub(crate) forward_m_per_s: f64,
    /// To the left.
    pub(crate) lateral_m_per_s: f64,
    /// Counterclockwise.
    pub(crate) turn_rad_per_s: f64,
}

/// Force on the centre of the robot and torque around it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct BodyForce {
    pub(crate) forward_n: f64,
    /// To the left.
    pub(crate) lateral_n: f64,
    /// Counterclockwise.
    pub(crate) torque_n_m: f64,
}
