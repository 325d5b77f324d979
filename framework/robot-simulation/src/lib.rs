//! The world of the reference robot and the devices that the robot sees of it.
//!
//! A [`Simulation`] holds the arena, the robot with its four driven wheels, its motion board and
//! its camera. Components reach the devices only as byte streams ([`Simulation::open`]), as they
//! would reach real ones. Nothing here reads a clock: [`Simulation::advance_to`] says what time it
//! is, so the same world, seed and bytes at the same times give the same drive, bit for bit.

#![forbid(unsafe_code)]

mod arena;
mod body_motion;
mod camera;
mod commanded_drive;
mod drive;
mod drive_record;
mod error;
mod fault;
mod geometry;
mod history;
mod line;
mod motion_board;
mod passage;
mod physics;
mod picture_of_drive;
mod random;
mod simulation;
mod smoke;
mod sonar;
mod sway;

pub use arena::{Arena, Solid, SolidKind};
pub use commanded_drive::{CommandedDrive, CyclePhases, EncoderCounts, WheelCommand};
pub use drive_record::RobotSummary;
pub use error::SimulationError;
pub use fault::{Fault, Side};
pub use geometry::Outline;
pub use line::Transport;
pub use picture_of_drive::draw_drive;
pub use simulation::{CAMERA, MOTION_BOARD, Simulation};
