//! What is known of the way, and what is decided.

use component_sdk::prelude::*;

/// What obstacles mean for the way, from either obstacle avoidance.
#[derive(PortData, Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct ObstacleReport {
    /// When it was made.
    #[unit("ns")]
    pub time: u64,
    /// From the robot's centre to the nearest echo; the farthest range of a sensor without one.
    #[unit("m")]
    pub nearest_distance: f64,
    /// Direction of that echo; 0 without one.
    #[unit("rad")]
    pub nearest_bearing: f64,
    /// Turn rate that leads past the obstacles.
    #[unit("rad/s")]
    pub evasive_turn_rate: f64,
    /// How much the obstacles matter: 0 leaves the way to the goal, 1 leaves it to the evasion.
    pub urgency: f64,
    /// Share of the cruising speed that is safe, 0 to 1.
    pub speed_share: f64,
}

/// Where the robot shall go, as a mission has chosen.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(C)]
pub struct GoalChoice {
    /// When it was chosen.
    #[unit("ns")]
    pub time: u64,
    /// 0: it stays where it is; 1 and 2: what the first or the second detector sees; 3: where it
    /// started.
    pub goal: u32,
    /// Nothing.
    pub reserved: u32,
}

/// How the robot shall move now.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct MotionDecision {
    /// When it was made.
    #[unit("ns")]
    pub time: u64,
    /// Forward speed of the robot's centre.
    #[unit("m/s")]
    pub speed: f64,
    /// Turn rate.
    #[unit("rad/s")]
    pub turn_rate: f64,
}
