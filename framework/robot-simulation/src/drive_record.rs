//! What is remembered of a drive: the score and what the picture of the drive shows.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use system_model::world::{Pose, Position};

use crate::arena::{Arena, SolidKind};
use crate::geometry::distance_m;
use crate::history::History;

/// Outlines nearer than this touch; the physics library keeps them about so far apart.
const TOUCH_M: f64 = 0.001;
/// A contact that comes back sooner is the same contact.
const CONTACT_PAUSE: Duration = Duration::from_millis(500);
/// Enough for half an hour at the rate of the path; then it gets coarser.
const PATH_CAPACITY: usize = 18_000;
const SENSED_CAPACITY: usize = 20_000;

/// How a drive went.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RobotSummary {
    /// The robot came within reach of the target.
    pub reached: bool,
    /// When it first did, in seconds of robot time.
    pub time_s: Option<f64>,
    /// Gap between the outlines of robot and target now.
    pub distance_to_target_m: f64,
    /// Distinct contacts with walls and obstacles; touching the target is none.
    pub collisions: u32,
    /// Smallest gap so far between the outlines of the robot and of any wall or obstacle.
    pub least_clearance_m: f64,
    /// Length of the way of the robot's centre.
    pub path_length_m: f64,
}

/// A point of the path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PathPoint {
    pub(crate) time: Duration,
    pub(crate) position: Position,
}

/// The record of one drive.
#[derive(Debug, Clone)]
pub(crate) struct DriveRecord {
    reached_at: Option<Duration>,
    distance_to_target_m: f64,
    collisions: u32,
    /// When each solid was last touched.
    touched_at: Vec<Option<Duration>>,
    least_clearance_m: f64,
    path_length_m: f64,
    last_position: Position,
    path: History<PathPoint>,
    sensed: History<Position>,
}

impl DriveRecord {
    pub(crate) fn new(start: Pose, solids: usize) -> Self {
        Self {
            reached_at: None,
            distance_to_target_m: f64::INFINITY,
            collisions: 0,
            touched_at: vec![None; solids],
            least_clearance_m: f64::INFINITY,
            path_length_m: 0.0,
            last_position: start.position,
            path: History::new(PATH_CAPACITY),
            sensed: History::new(SENSED_CAPACITY),
        }
    }

    /// Takes the gaps between the robot and each solid of the arena, in their order.
    pub(crate) fn take_distances(
        &mut self,
        now: Duration,
        arena: &Arena,
        distances_m: impl Iterator<Item = f64>,
        reach_distance_m: f64,
    ) {
        for (index, (solid, gap_m)) in arena.solids.iter().zip(distances_m).enumerate() {
            if solid.kind == SolidKind::Target {
                self.distance_to_target_m = gap_m;
                continue;
            }
            self.least_clearance_m = self.least_clearance_m.min(gap_m);
            if gap_m <= TOUCH_M {
                let before = self.touched_at[index].replace(now);
                if before.is_none_or(|before| now - before > CONTACT_PAUSE) {
                    self.collisions += 1;
                }
            }
        }
        if self.reached_at.is_none() && self.distance_to_target_m <= reach_distance_m {
            self.reached_at = Some(now);
        }
    }

    pub(crate) fn take_position(&mut self, position: Position) {
        self.path_length_m += distance_m(self.last_position, position);
        self.last_position = position;
    }

    pub(crate) fn mark_path(&mut self, time: Duration, position: Position) {
        self.path.offer(PathPoint { time, position });
    }

    /// Takes a point at which a sonar saw something.
    pub(crate) fn take_sensed(&mut self, position: Position) {
        self.sensed.offer(position);
    }

    pub(crate) fn path(&self) -> &[PathPoint] {
        self.path.values()
    }

    pub(crate) fn sensed(&self) -> &[Position] {
        self.sensed.values()
    }

    pub(crate) fn summary(&self) -> RobotSummary {
        RobotSummary {
            reached: self.reached_at.is_some(),
            time_s: self.reached_at.map(|time| time.as_secs_f64()),
            distance_to_target_m: self.distance_to_target_m,
            collisions: self.collisions,
            least_clearance_m: self.least_clearance_m,
            path_length_m: self.path_length_m,
        }
    }
}
