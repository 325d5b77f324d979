//! Those who do the task: the robots of this system, and others if there is a way to them. Of all robots
//! one decides (`leading`), the others do what it asks for (`following`); a robot that is alone decides.

use std::sync::Arc;
use std::time::Duration;

use robot_network::Fence;
use robot_network::task::{Number, Placed, RobotReport, Step, TaskContent};
use system_model::task::{Placement, RobotIndex, TaskSpecification};
use task_adaptation::{Answer, Candidate, Observation};

use super::following::Following;
use super::leading::{OpenRehearsal, TeamChange};
use super::local::LocalRobot;
use super::passage::Teammates;
use crate::lane::Lane;
use crate::wake::Wake;

/// How often robots tell each other how they do where nothing is new, and what runs: a few times
/// within the limit of silence.
const TELL_PERIOD: Duration = Duration::from_millis(100);

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
    met: Vec<bool>,
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
    has_changed: bool,
    told_at: Option<Duration>,
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
        while let Some((robot, message)) = self.own.passage.as_mut().and_then(|it| it.heard()) {
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

    /// Looks after this system's part of what runs, and tells others of it; whether there is something
    /// new to evaluate.
    pub fn listen(&mut self, running: &[Placement], lane: &Lane) -> bool {
        self.own.hear();
        if !self.is_changing() {
            self.own.keep_asleep(&self.actual, lane);
        }
        let is_new =
            std::mem::take(&mut self.own.has_heard) || self.own.binding.watches_age(running);
        if self.own.passage.is_none() {
            return is_new;
        }
        let now = self.own.now();
        let is_due = self.told_at.is_none_or(|at| at + TELL_PERIOD <= now);
        if is_due && self.decides() {
            self.tell_what_runs(running, None);
        }
        if is_due || is_new && !self.decides() {
            self.report(is_new);
            self.told_at = Some(now);
        }
        let mut came = false;
        for report in self.reports.iter_mut().flatten() {
            came |= std::mem::take(&mut report.is_new);
        }
        is_new || came
    }

    /// Tells all others what this system has and how well it does.
    pub(super) fn report(&mut self, is_new: bool) {
        if !self.decides() {
            self.own.sense_resources();
            self.own.look_for_losses();
        }
        let task = self.own.task_as_it_is();
        let following = self.following.as_ref();
        let running = following.map_or(&self.actual, |following| &following.wanted);
        let running = running.clone();
        let performances = match self.own.performances(&running) {
            Some(Answer::Performances(performances)) => performances,
            _ => Vec::new(),
        };
        for robot in self.own.binding.robots.clone() {
            let had = &task.robots[robot];
            let pairs = running.iter().zip(&performances);
            let own = pairs.filter(|(placement, _)| placement.robot == robot);
            let report = RobotReport {
                components: had.instances.iter().map(|it| it.component).collect(),
                available: had.available.iter().map(|it| Number::from(*it)).collect(),
                performances: own
                    .map(|(placement, it)| {
                        let uses = it.use_of_resources.iter().map(|it| Number::from(*it));
                        (placement.component, it.functional.into(), uses.collect())
                    })
                    .collect(),
                is_new,
            };
            self.tell_all(&TaskContent::Report(report));
        }
    }

    /// Another robot has told how it does.
    pub(super) fn take_report(&mut self, robot: RobotIndex, report: RobotReport) {
        let has = |it: &RobotReport| (it.components.clone(), it.available.clone());
        let old = self.reports[robot].as_ref();
        self.has_changed |= old.map(has) != Some(has(&report));
        let was_new = old.is_some_and(|it| it.is_new);
        let is_new = report.is_new || was_new;
        self.reports[robot] = Some(RobotReport { is_new, ..report });
        self.met[robot] = true;
    }

    /// The task with what robots have now, if that has changed.
    pub fn changed_task(&mut self) -> Option<TaskSpecification> {
        let sensed = self.own.sense_resources();
        let lost = self.own.look_for_losses();
        let changed = std::mem::take(&mut self.has_changed);
        (sensed || lost || changed).then(|| self.task_as_it_is())
    }

    fn task_as_it_is(&self) -> TaskSpecification {
        let mut task = self.own.task_as_it_is();
        for (index, robot) in task.robots.iter_mut().enumerate() {
            if self.is_own(index) {
                continue;
            }
            let Some(report) = &self.reports[index] else {
                if self.met[index] {
                    robot.instances.clear();
                }
                continue;
            };
            let has = |component| report.components.contains(&component);
            robot.instances.retain(|it| has(it.component));
            for (available, told) in robot.available.iter_mut().zip(&report.available) {
                let told = f64::from(*told);
                // A robot that lies does not change what is known.
                if told.is_finite() && told >= 0.0 {
                    *available = told;
                }
            }
        }
        task
    }

    /// What evaluators say of what runs; none where nothing is known yet.
    pub fn evaluate(&self, running: &[Placement]) -> Option<Answer> {
        let answer = self.own.performances(running)?;
        let Answer::Performances(mut performances) = answer else {
            return Some(answer);
        };
        for (placement, performance) in running.iter().zip(&mut performances) {
            if self.is_own(placement.robot) {
                continue;
            }
            let report = self.reports[placement.robot].as_ref()?;
            let mut told = report.performances.iter();
            let (_, error, uses) = told.find(|(of, ..)| *of == placement.component)?;
            performance.functional = f64::from(*error);
            performance.use_of_resources = uses.iter().map(|it| f64::from(*it)).collect();
        }
        Some(Answer::Performances(performances))
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
