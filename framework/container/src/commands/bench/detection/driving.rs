//! Commands like those of the reference robot's path planner: from goal to goal, past obstacles,
//! with turns on the spot and stops between.

use std::f64::consts::{PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use robot_simulation::{EncoderCounts, WheelCommand};

/// Of the reference robot.
pub(super) const METRES_PER_TICK: f64 = TAU * WHEEL_RADIUS_M / 360.0;
const WHEEL_RADIUS_M: f64 = 0.0325;
const TRACK_M: f64 = 0.12;
const WHEEL_MAXIMUM_RPM: f64 = 100.0;
/// The planner's: cruising speed, gain and limit of the turn towards the goal, bearing from which
/// it turns on the spot, turn rate of a search.
const CRUISE_M_PER_S: f64 = 0.29;
const ATTRACTION_PER_S: f64 = 2.5;
const ATTRACTION_MAXIMUM_RAD_PER_S: f64 = 1.4;
const ON_THE_SPOT_RAD: f64 = 1.2;
const SEARCH_RAD_PER_S: f64 = 1.2;
/// Cycles of 20 ms from one decision, and from one picture, to the next.
const DECISION_CYCLES: u64 = 2;
const PICTURE_CYCLES: u64 = 6;
/// The camera finds the target within half a degree.
const BEARING_ERROR_RAD: f64 = 0.01;
/// An obstacle comes near every six seconds or so.
const OBSTACLE_PER_DECISION: f64 = 0.007;
/// Goals lie in a square of this half width around the start, away from all walls.
const GOALS_M: f64 = 20.0;
const ARRIVED_M: f64 = 0.45;

/// Who drives.
pub(super) struct Driver {
    random: Pcg64,
    cycle: u64,
    counts: Option<EncoderCounts>,
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    goal: (f64, f64),
    /// Where the goal was seen in the last picture.
    bearing_rad: f64,
    task: Task,
    task_end: u64,
    obstacle: Option<Obstacle>,
    command: WheelCommand,
}

#[derive(Clone, Copy)]
enum Task {
    Stand,
    /// Turn on the spot.
    Search(f64),
    Approach,
}

/// Something that comes near and is passed; its urgency rises and falls.
#[derive(Clone, Copy)]
struct Obstacle {
    begin: u64,
    cycles: u64,
    turn_rad_per_s: f64,
    speed_share: f64,
}

impl Driver {
    pub(super) fn new(seed: u64) -> Self {
        Self {
            random: Pcg64::seed_from_u64(seed),
            cycle: 0,
            counts: None,
            x_m: 0.0,
            y_m: 0.0,
            heading_rad: 0.0,
            goal: (0.0, 0.0),
            bearing_rad: 0.0,
            task: Task::Stand,
            task_end: 25,
            obstacle: None,
            command: WheelCommand::default(),
        }
    }

    /// What is commanded in the next cycle.
    pub(super) fn command(&mut self, counts: EncoderCounts) -> WheelCommand {
        self.follow(counts);
        if self.cycle.is_multiple_of(DECISION_CYCLES) {
            let (speed_m_per_s, turn_rad_per_s) = self.decide();
            self.command = wheels(speed_m_per_s, turn_rad_per_s);
        }
        self.cycle += 1;
        self.command
    }

    fn follow(&mut self, counts: EncoderCounts) {
        let last = self.counts.replace(counts).unwrap_or(counts);
        let left_m = f64::from(counts.left.wrapping_sub(last.left)) * METRES_PER_TICK;
        let right_m = f64::from(counts.right.wrapping_sub(last.right)) * METRES_PER_TICK;
        let turn_rad = (right_m - left_m) / TRACK_M;
        let direction_rad = self.heading_rad + turn_rad / 2.0;
        self.x_m += f64::midpoint(left_m, right_m) * direction_rad.cos();
        self.y_m += f64::midpoint(left_m, right_m) * direction_rad.sin();
        self.heading_rad += turn_rad;
    }

    fn decide(&mut self) -> (f64, f64) {
        if self.cycle >= self.task_end {
            self.next_task();
        }
        match self.task {
            Task::Stand => (0.0, 0.0),
            Task::Search(turn_rad_per_s) => (0.0, turn_rad_per_s),
            Task::Approach => self.approach(),
        }
    }

    fn next_task(&mut self) {
        let (task, cycles) = match self.task {
            Task::Approach if self.random.random_bool(0.5) => {
                let sign = if self.random.random_bool(0.5) {
                    1.0
                } else {
                    -1.0
                };
                (Task::Search(sign * SEARCH_RAD_PER_S), 20..280)
            }
            Task::Approach => (Task::Stand, 25..150),
            Task::Stand | Task::Search(_) => {
                let distance_m = self.random.random_range(1.0..6.0);
                let direction_rad: f64 = self.random.random_range(0.0..TAU);
                let near = |from: f64, way: f64| (from + way).clamp(-GOALS_M, GOALS_M);
                self.goal = (
                    near(self.x_m, distance_m * direction_rad.cos()),
                    near(self.y_m, distance_m * direction_rad.sin()),
                );
                (Task::Approach, 250..1500)
            }
        };
        self.task = task;
        self.task_end = self.cycle + self.random.random_range(cycles);
    }

    fn approach(&mut self) -> (f64, f64) {
        let (x_m, y_m) = (self.goal.0 - self.x_m, self.goal.1 - self.y_m);
        if x_m.hypot(y_m) < ARRIVED_M {
            self.task_end = self.cycle;
        }
        if self.cycle.is_multiple_of(PICTURE_CYCLES) {
            let bearing_rad = y_m.atan2(x_m) - self.heading_rad;
            let error_rad = self
                .random
                .random_range(-BEARING_ERROR_RAD..BEARING_ERROR_RAD);
            self.bearing_rad = (bearing_rad + PI).rem_euclid(TAU) - PI + error_rad;
        }
        let (urgency, evasion_rad_per_s, speed_share) = self.evade();
        let freedom = 1.0 - urgency;
        let attraction_rad_per_s = (ATTRACTION_PER_S * self.bearing_rad)
            .clamp(-ATTRACTION_MAXIMUM_RAD_PER_S, ATTRACTION_MAXIMUM_RAD_PER_S);
        let aside = (self.bearing_rad.abs() / ON_THE_SPOT_RAD).min(1.0);
        (
            CRUISE_M_PER_S * speed_share * (1.0 - freedom * aside),
            freedom * attraction_rad_per_s + evasion_rad_per_s,
        )
    }

    /// Urgency, turn rate and share of the speed that the obstacle asks for; sonars are noisy.
    fn evade(&mut self) -> (f64, f64, f64) {
        if self.obstacle.is_none() && self.random.random_bool(OBSTACLE_PER_DECISION) {
            self.obstacle = Some(Obstacle {
                begin: self.cycle,
                cycles: self.random.random_range(40..160),
                turn_rad_per_s: self.random.random_range(-1.8..1.8),
                speed_share: self.random.random_range(0.1..0.9),
            });
        }
        let Some(obstacle) = self.obstacle else {
            return (0.0, 0.0, 1.0);
        };
        let passed = (self.cycle - obstacle.begin) as f64 / obstacle.cycles as f64;
        if passed >= 1.0 {
            self.obstacle = None;
        }
        let urgency = (1.0 - (2.0 * passed - 1.0).abs()).clamp(0.0, 1.0);
        let felt = urgency * self.random.random_range(0.95..1.05);
        (
            urgency,
            obstacle.turn_rad_per_s * felt,
            1.0 - (1.0 - obstacle.speed_share) * felt,
        )
    }
}

/// As actuator control turns a decision into a command: the turn is kept, the speed gives way.
fn wheels(speed_m_per_s: f64, turn_rad_per_s: f64) -> WheelCommand {
    let rpm = |rim_m_per_s: f64| rim_m_per_s / WHEEL_RADIUS_M * 60.0 / TAU;
    let maximum = WHEEL_MAXIMUM_RPM;
    let turn_rpm = rpm(turn_rad_per_s * TRACK_M / 2.0).clamp(-maximum, maximum);
    let room_rpm = maximum - turn_rpm.abs();
    let speed_rpm = rpm(speed_m_per_s).clamp(-room_rpm, room_rpm);
    WheelCommand::from_wheel_rpm(speed_rpm - turn_rpm, speed_rpm + turn_rpm)
}
