//! Who does what the decider asks for: this robot alone, or together with others.

use system_model::task::{Placement, TaskSpecification};
use task_adaptation::{Answer, Candidate, Observation};

use super::change::Progress;
use super::local::LocalRobot;
use crate::lane::Lane;

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

/// Evaluates, estimates and changes what runs. Answers may come at once or later; each is an
/// observation of the decider, which drops what comes too late.
pub trait Performer: Send {
    /// Takes what has come since the last time; whether what runs is to be evaluated.
    fn listen(&mut self, running: &[Placement], lane: &Lane) -> bool;

    /// Whether a component of this system takes part in the task.
    fn owns(&self, component: usize) -> bool;

    /// Whether what runs has a component of this system in it.
    fn uses(&self, running: &[Placement], component: usize) -> bool;

    /// A component of this system cannot be brought back.
    fn give_up(&mut self, component: usize);

    /// The task with what robots have now, if that has changed.
    fn changed_task(&mut self) -> Option<TaskSpecification>;

    /// What evaluators say of what runs; none where nothing is known yet.
    fn evaluate(&mut self, running: &[Placement]) -> Option<Answer>;

    /// Has a candidate's estimators run for their cycles.
    fn estimate(&mut self, request: Request<'_>, lane: &Lane) -> Option<Observation>;

    /// Lets a candidate run instead of what runs.
    fn reconfigure(&mut self, request: Request<'_>, lane: &Lane) -> Option<Observation>;

    /// Gives the change up that is under way; what ran before goes on.
    fn abandon(&mut self, lane: &Lane);

    /// Whether a change is under way: then it wants to go on soon.
    fn is_changing(&self) -> bool;

    /// Goes on with what is under way, and answers.
    fn go_on(&mut self, lane: &Lane) -> Option<Observation>;
}

impl Performer for LocalRobot {
    fn listen(&mut self, running: &[Placement], lane: &Lane) -> bool {
        self.hear();
        self.keep_asleep(running, lane);
        std::mem::take(&mut self.has_heard) || self.binding.watches_age(running)
    }

    fn owns(&self, component: usize) -> bool {
        self.binding.task_component(component).is_some()
    }

    fn uses(&self, running: &[Placement], component: usize) -> bool {
        self.members(running).contains(&component)
    }

    fn give_up(&mut self, component: usize) {
        self.losses.give_up(component);
    }

    fn changed_task(&mut self) -> Option<TaskSpecification> {
        let sensed = self.sense_resources();
        let lost = self.look_for_losses();
        (sensed || lost).then(|| self.task_as_it_is())
    }

    fn evaluate(&mut self, running: &[Placement]) -> Option<Answer> {
        self.performances(running)
    }

    fn estimate(&mut self, request: Request<'_>, lane: &Lane) -> Option<Observation> {
        let placements = &request.candidate.placements;
        let answer = match self.elsewhere(placements) {
            Some(robot) => Answer::Crashed(format!("{robot} is not connected")),
            None => LocalRobot::estimate(self, placements, request.running, lane),
        };
        Some(Observation::Estimated {
            decision: request.decision,
            number: request.number,
            answer,
        })
    }

    fn reconfigure(&mut self, request: Request<'_>, lane: &Lane) -> Option<Observation> {
        let placements = &request.candidate.placements;
        self.asked = (request.decision, request.number);
        let begun = match self.elsewhere(placements) {
            Some(robot) => Err(format!("{robot} is not connected")),
            None => self.begin_change(placements, request.running, lane),
        };
        begun.err().map(|reason| self.failed(reason))
    }

    fn abandon(&mut self, lane: &Lane) {
        self.go_back(lane);
    }

    fn is_changing(&self) -> bool {
        self.change.is_some()
    }

    fn go_on(&mut self, lane: &Lane) -> Option<Observation> {
        let (decision, number) = self.asked;
        self.hear();
        match LocalRobot::go_on(self, lane) {
            Progress::UnderWay => None,
            Progress::Done => Some(Observation::Reconfigured { decision, number }),
            Progress::Failed(reason) => Some(self.failed(reason)),
        }
    }
}

impl LocalRobot {
    fn failed(&self, reason: String) -> Observation {
        let (decision, number) = self.asked;
        Observation::ReconfigurationFailed {
            decision,
            number,
            reason,
        }
    }

    /// The first robot of placements that is not this one.
    fn elsewhere(&self, placements: &[Placement]) -> Option<&str> {
        let mut placements = placements.iter();
        let other = placements.find(|it| it.robot != self.binding.robot)?;
        Some(&self.binding.task.robots[other.robot].name)
    }
}
