//! Those who do the task: the robots of this system, and others if there is a way to them. Of all robots
//! one decides (`leading`), the others do what it asks for (`following`); a robot that is alone decides.

use std::sync::Arc;
use std::time::Duration;

use robot_network::Fence;
use robot_network::task::{Placed, RobotReport, Step, TaskContent};
use system_model::task::{Placement, RobotIndex};
use task_adaptation::{Candidate, Observation};

use super::asking::OpenRehearsal;
use super::following::Following;
use super::leading::TeamChange;
use super::local::LocalRobot;
use super::passage::Teammates;
use crate::lane::Lane;
use crate::wake::Wake;

/// Messages that are taken before this robot's own work has its turn: answers to all questions of a
/// decision on the twelve candidates of two robots many times over.
const MESSAGES_AT_ONCE: usize = 256;

/// A question or an order of the decider.
#[derive(Debug, Clone, Copy)]
pub struct Request<'decider> {
    /// Number of the decision.
    pub decision: u64,
    /// Number of the candidate in it.
    pub number: usize,
    /// The candidate.
    pub candidate: &'decider Candidate,
    /// What runs.
    pub running: &'decider [Placement],
}

/// What others have brought about.
#[derive(Debug, Default)]
pub struct News {
    /// What runs, as the one who decides says.
    pub running: Option<Vec<Placement>>,
    /// How a decision of his has ended, in words.
    pub decided: Option<String>,
    /// Answers for this robot's decider.
    pub answers: Vec<Observation>,
}

/// Those who do the task.
pub struct Team {
    pub(super) own: LocalRobot,
    pub(super) mates: Teammates,
    /// What robots elsewhere have told of themselves last.
    pub(super) reports: Vec<Option<RobotReport>>,
    /// Robots elsewhere that have been there: one that was never heard of is waited for, not lost.
    pub(super) met: Vec<bool>,
    /// Whose orders count.
    pub(super) fence: Fence,
    /// What this system's components are connected for.
    pub(super) actual: Vec<Placement>,
    pub(super) open: Vec<OpenRehearsal>,
    pub(super) change: Option<TeamChange>,
    pub(super) following: Option<Following>,
    /// Which step of a rehearsal runs components, and for whom if not for this robot itself.
    pub(super) rehearsing: Option<(Option<RobotIndex>, Step)>,
    /// What others have was different when the task was changed last.
    pub(super) has_changed: bool,
    pub(super) told_at: Option<Duration>,
    /// Whether connections are made that lead from robot to robot from the beginning.
    has_begun: bool,
}

impl Team {
    /// A team of which nobody is known yet but this system's robots.
    pub fn new(own: LocalRobot) -> Self {
        let running = own.binding.task.running.clone().unwrap_or_default();
        Self {
            mates: Teammates::default(),
            reports: own.binding.task.robots.iter().map(|_| None).collect(),
            met: own.binding.task.robots.iter().map(|_| false).collect(),
            fence: Fence::default(),
            actual: running,
            open: Vec::new(),
            change: None,
            following: None,
            rehearsing: None,
            has_changed: true,
            told_at: None,
            has_begun: false,
            own,
        }
    }

    /// What becomes awake when others have told something.
    pub fn wake(&self) -> Option<Arc<Wake>> {
        self.own.passage.as_ref().map(|passage| passage.wake())
    }

    /// Whether this system decides: it is alone, or of all alive its robot comes first.
    pub fn decides(&self) -> bool {
        let decider = self.mates.decider;
        self.own.passage.is_none() || decider.is_some_and(|it| self.is_own(it))
    }

    pub(super) fn is_own(&self, robot: RobotIndex) -> bool {
        self.own.binding.robots.contains(&robot)
    }

    /// Whether a component of this system takes part in the task.
    pub fn owns(&self, component: usize) -> bool {
        self.own.binding.part_of(component).is_some()
    }

    /// Whether what runs has a component of this system in it.
    pub fn uses(&self, running: &[Placement], component: usize) -> bool {
        self.own.members(running).contains(&component)
    }

    /// A component of this system cannot be brought back.
    pub fn give_up(&mut self, component: usize) {
        self.own.losses.give_up(component);
    }

    /// Takes what others have told, and does what they ask for. Runs code of components.
    pub fn attend(&mut self, running: &[Placement], lane: &Lane) -> News {
        let mut news = News::default();
        if !std::mem::replace(&mut self.has_begun, true) {
            self.own.connect_robots(&self.actual, lane);
        }
        if self.decides() && !self.is_changing() {
            self.actual = running.to_vec();
        }
        let Some(passage) = &self.own.passage else {
            return news;
        };
        let mates = passage.team();
        if mates != self.mates {
            self.meet(mates, lane);
        }
        for _ in 0..MESSAGES_AT_ONCE {
            let Some((robot, message)) = self.own.passage.as_mut().and_then(|it| it.heard()) else {
                break;
            };
            self.take(robot, message, &mut news, lane);
        }
        if let Some(running) = &news.running {
            self.adopt(running.clone(), lane);
        }
        self.follow_through(lane);
        news
    }

    /// Others have come or gone, or another one decides.
    fn meet(&mut self, mates: Teammates, lane: &Lane) {
        let decided = self.decides();
        let was = std::mem::replace(&mut self.mates, mates);
        for (robot, report) in self.reports.iter_mut().enumerate() {
            if !self.mates.alive.contains(&robot) && report.take().is_some() {
                self.has_changed = true;
            }
        }
        if was.decider != self.mates.decider {
            // What the former one has begun nobody would end.
            self.open.clear();
            if decided && !self.decides() {
                self.abandon(lane);
            }
            self.stop_following(lane);
        }
    }

    pub(super) fn tell(&mut self, robot: RobotIndex, content: TaskContent) {
        if let Some(passage) = &mut self.own.passage {
            passage.tell(robot, content);
        }
    }

    pub(super) fn tell_all(&mut self, content: &TaskContent) {
        for robot in self.mates.alive.clone() {
            if !self.is_own(robot) {
                self.tell(robot, content.clone());
            }
        }
    }

    /// Tells all others what runs, and how a decision has ended.
    pub fn tell_what_runs(&mut self, running: &[Placement], decided: Option<String>) {
        self.tell_all(&TaskContent::Running {
            placements: placed(running),
            decided,
        });
    }

    /// Placements that another robot has told; none if there are no such.
    pub(super) fn placements(&self, told: &[Placed]) -> Option<Vec<Placement>> {
        let task = &self.own.binding.task;
        let placements = told.iter().map(|(component, robot)| {
            let (component, robot) = (*component, *robot);
            let placement = Placement { component, robot };
            task.instance(placement).map(|_| placement)
        });
        placements.collect()
    }
}

/// Placements as they are told.
pub(super) fn placed(placements: &[Placement]) -> Vec<Placed> {
    let placements = placements.iter();
    placements.map(|it| (it.component, it.robot)).collect()
}
