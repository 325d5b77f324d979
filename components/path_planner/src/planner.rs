//! The decision: towards the target as far as the obstacles leave it open.

use component_sdk::PortData;
use robot_interface::port_data::{DetectedObject, MotionDecision, ObstacleReport, WheelOdometry};

use crate::goal_memory::{Goal, GoalMemory};
use crate::search::{Search, SearchPhase};

const ATTRACTION_GAIN_PER_S: f64 = 2.5;
const ATTRACTION_MAXIMUM_RAD_PER_S: f64 = 1.4;
const SEARCH_TURN_RATE_RAD_PER_S: f64 = 1.2;
/// From this bearing of the target on the robot turns on the spot, unless obstacles decide.
const ON_THE_SPOT_RAD: f64 = 1.2;
/// Odometry and obstacle reports older than this are no ground to drive on: several cycles of
/// whoever makes them.
const FRESH_NS: u64 = 300_000_000;
/// As above, for a camera of ten pictures a second.
const OBJECT_FRESH_NS: u64 = 1_000_000_000;
/// From the robot's centre to its front.
const FRONT_M: f64 = 0.105;
/// So near to the target its echo can be told from those of obstacles.
const TARGET_NEAR_M: f64 = 0.6;
/// The nearest echo is the target's if it is at most this far off, in bearing and distance: a sonar
/// knows the direction of an echo within 15 degrees.
const TARGET_BEARING_OFF_RAD: f64 = 0.5;
const TARGET_DISTANCE_OFF_M: f64 = 0.12;

/// What the integrator may choose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Planner {
    /// Speed where nothing is near.
    pub cruise_speed_m_per_s: f64,
    /// Gap between robot and target at which the robot stands.
    pub arrival_distance_m: f64,
    /// Radius of the target.
    pub target_radius_m: f64,
}

impl Default for Planner {
    /// For the reference scenario: 85 rpm, and well within the distance at which the target counts
    /// as reached.
    fn default() -> Self {
        Self {
            cruise_speed_m_per_s: 0.29,
            arrival_distance_m: 0.20,
            target_radius_m: 0.12,
        }
    }
}

/// What must be remembered.
#[derive(PortData, Debug, Clone, Copy)]
#[repr(C)]
pub struct PlannerMemory {
    goal: GoalMemory,
    search: Search,
    /// Which way the robot turns to search: to the side of the last sighting.
    side: f64,
    /// When the detector said something last, and whether it ever did.
    object_at: u64,
    has_object: u32,
}

impl Default for PlannerMemory {
    fn default() -> Self {
        Self {
            goal: GoalMemory::default(),
            search: Search::default(),
            side: 1.0,
            object_at: 0,
            has_object: 0,
        }
    }
}

/// What is known in one cycle.
#[derive(Debug, Clone, Copy)]
pub struct Situation {
    /// Now.
    pub time_ns: u64,
    /// What the detector said since the last cycle.
    pub object: Option<DetectedObject>,
    /// The last report of the obstacle avoidance.
    pub obstacles: Option<ObstacleReport>,
    /// The last odometry.
    pub odometry: Option<WheelOdometry>,
}

impl Planner {
    /// How to move now. Without odometry, eyes or a fresh obstacle report the robot stands.
    pub fn plan(&self, memory: &mut PlannerMemory, situation: &Situation) -> MotionDecision {
        let time_ns = situation.time_ns;
        let stand = MotionDecision {
            time: time_ns,
            ..MotionDecision::default()
        };
        let is_fresh = |made_at: u64| time_ns.saturating_sub(made_at) < FRESH_NS;
        let Some(pose) = situation.odometry.filter(|pose| is_fresh(pose.time)) else {
            return stand;
        };
        memory.look(situation, &pose);
        let Some(obstacles) = situation.obstacles.filter(|report| is_fresh(report.time)) else {
            return stand;
        };
        if !memory.has_eyes(time_ns) {
            return stand;
        }
        let (speed, turn_rate) = match memory.goal.goal(time_ns, &pose) {
            Some(goal) => {
                memory.search.end();
                self.approach(&goal, &obstacles)
            }
            None => self.search(memory, time_ns, &obstacles),
        };
        MotionDecision {
            time: time_ns,
            speed,
            turn_rate,
        }
    }

    /// Speed in m/s and turn rate in rad/s towards the goal.
    fn approach(&self, goal: &Goal, obstacles: &ObstacleReport) -> (f64, f64) {
        let attraction_rad_per_s = (ATTRACTION_GAIN_PER_S * goal.bearing_rad)
            .clamp(-ATTRACTION_MAXIMUM_RAD_PER_S, ATTRACTION_MAXIMUM_RAD_PER_S);
        let gap_m = goal.distance_m - self.target_radius_m - FRONT_M;
        let cruise_m_per_s = self.cruise_speed_m_per_s * obstacles.speed_share;
        if gap_m <= self.arrival_distance_m {
            return (0.0, attraction_rad_per_s);
        }
        let aside = (goal.bearing_rad.abs() / ON_THE_SPOT_RAD).min(1.0);
        if self.is_target(goal, obstacles) {
            return (cruise_m_per_s * (1.0 - aside), attraction_rad_per_s);
        }
        let freedom = 1.0 - obstacles.urgency.clamp(0.0, 1.0);
        (
            cruise_m_per_s * (1.0 - freedom * aside),
            freedom * attraction_rad_per_s + obstacles.evasive_turn_rate,
        )
    }

    /// Whether what the sonars see first is the target itself.
    fn is_target(&self, goal: &Goal, obstacles: &ObstacleReport) -> bool {
        let surface_m = goal.distance_m - self.target_radius_m;
        surface_m < TARGET_NEAR_M
            && (obstacles.nearest_bearing - goal.bearing_rad).abs() < TARGET_BEARING_OFF_RAD
            && obstacles.nearest_distance > surface_m - TARGET_DISTANCE_OFF_M
    }

    fn search(
        &self,
        memory: &mut PlannerMemory,
        time_ns: u64,
        obstacles: &ObstacleReport,
    ) -> (f64, f64) {
        match memory.search.phase(time_ns) {
            SearchPhase::Turn => (0.0, SEARCH_TURN_RATE_RAD_PER_S * memory.side),
            SearchPhase::Stretch => (
                self.cruise_speed_m_per_s * obstacles.speed_share,
                obstacles.evasive_turn_rate,
            ),
        }
    }
}

impl PlannerMemory {
    fn look(&mut self, situation: &Situation, pose: &WheelOdometry) {
        let Some(object) = &situation.object else {
            return;
        };
        self.object_at = situation.time_ns;
        self.has_object = 1;
        if object.visible != 0 {
            self.goal.see(situation.time_ns, object, pose);
            self.side = if object.bearing >= 0.0 { 1.0 } else { -1.0 };
        }
    }

    fn has_eyes(&self, time_ns: u64) -> bool {
        self.has_object != 0 && time_ns.saturating_sub(self.object_at) < OBJECT_FRESH_NS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: ObstacleReport = ObstacleReport {
        time: 0,
        nearest_distance: 3.0,
        nearest_bearing: 0.0,
        evasive_turn_rate: 0.0,
        urgency: 0.0,
        speed_share: 1.0,
    };

    fn situation(object: DetectedObject, obstacles: ObstacleReport) -> Situation {
        Situation {
            time_ns: 0,
            object: Some(object),
            obstacles: Some(obstacles),
            odometry: Some(WheelOdometry::default()),
        }
    }

    fn seen(distance: f64, bearing: f64) -> DetectedObject {
        DetectedObject {
            visible: 1,
            bearing,
            distance,
            ..DetectedObject::default()
        }
    }

    fn plan(situation: &Situation) -> (f64, f64) {
        let decision = Planner::default().plan(&mut PlannerMemory::default(), situation);
        (decision.speed, decision.turn_rate)
    }

    #[test]
    fn the_robot_stands_while_it_does_not_know_enough() {
        let whole = situation(seen(2.0, 0.0), FREE);
        assert!(plan(&whole).0 > 0.2);
        for lacking in [
            Situation {
                odometry: None,
                ..whole
            },
            Situation {
                obstacles: None,
                ..whole
            },
            Situation {
                object: None,
                ..whole
            },
            Situation {
                time_ns: FRESH_NS,
                ..whole
            },
        ] {
            assert_eq!(plan(&lacking), (0.0, 0.0), "{lacking:?}");
        }
    }

    #[test]
    fn it_turns_towards_the_target() {
        let (speed, turn_rate) = plan(&situation(seen(2.0, 0.3), FREE));
        assert!(speed > 0.1 && turn_rate > 0.5);
        assert!(plan(&situation(seen(2.0, -0.3), FREE)).1 < -0.5);
    }

    #[test]
    fn an_urgent_obstacle_decides() {
        let obstacles = ObstacleReport {
            nearest_distance: 0.3,
            evasive_turn_rate: -1.5,
            urgency: 1.0,
            speed_share: 0.2,
            ..FREE
        };
        let (speed, turn_rate) = plan(&situation(seen(2.0, 0.3), obstacles));
        assert!((turn_rate + 1.5).abs() < 1e-12 && (speed - 0.2 * 0.29).abs() < 1e-12);
    }

    #[test]
    fn the_target_itself_is_no_obstacle_and_is_not_touched() {
        let target_ahead = ObstacleReport {
            nearest_distance: 0.42,
            evasive_turn_rate: -1.5,
            urgency: 0.9,
            speed_share: 0.4,
            ..FREE
        };
        let (speed, turn_rate) = plan(&situation(seen(0.45, 0.0), target_ahead));
        assert!(speed > 0.05 && turn_rate.abs() < 1e-9);
        assert_eq!(plan(&situation(seen(0.30, 0.0), target_ahead)).0, 0.0);
    }

    #[test]
    fn without_a_target_it_turns_then_drives_on() {
        let planner = Planner::default();
        let mut memory = PlannerMemory::default();
        let nothing = DetectedObject::default();
        let mut cycles_of = [0, 0];
        for cycle in 0..250 {
            let time_ns = cycle * 40_000_000;
            let mut now = situation(
                nothing,
                ObstacleReport {
                    time: time_ns,
                    ..FREE
                },
            );
            now.time_ns = time_ns;
            now.odometry = Some(WheelOdometry {
                time: time_ns,
                ..WheelOdometry::default()
            });
            let decision = planner.plan(&mut memory, &now);
            cycles_of[usize::from(decision.speed > 0.0)] += 1;
        }
        // 5.6 s of turning, 3 s of driving, and turning again.
        assert_eq!(cycles_of, [175, 75]);
    }
}
