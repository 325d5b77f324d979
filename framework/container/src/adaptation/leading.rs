//! The one who decides has candidates brought about, here and elsewhere.

use robot_network::task::{Bytes, Step, TaskContent};
use system_model::task::{Placement, RobotIndex};
use task_adaptation::{Observation, judge};

use super::change::Progress;
use super::team::{Request, Team, placed};
use crate::lane::Lane;

/// A change that is under way.
pub struct TeamChange {
    pub(super) step: Step,
    wanted: Vec<Placement>,
    before: Vec<Placement>,
    /// Robots elsewhere that take part.
    robots: Vec<RobotIndex>,
    stage: Stage,
    /// Who has still to answer.
    waiting: Vec<RobotIndex>,
    /// Memory of components that go from robot to robot.
    memories: Vec<(usize, Bytes)>,
    /// Why it cannot be done.
    failure: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// The memory of components that leave is asked for.
    Remembering,
    /// Others begin.
    Beginning,
    /// All have begun, this system too; inputs change over.
    Switching,
}

impl Team {
    /// Lets a candidate run instead of what runs.
    pub fn reconfigure(&mut self, request: Request<'_>, lane: &Lane) {
        self.open.clear();
        let wanted = request.candidate.placements.clone();
        let before = request.running.to_vec();
        let mut robots: Vec<RobotIndex> = wanted.iter().chain(&before).map(|it| it.robot).collect();
        robots.sort_unstable();
        robots.dedup();
        robots.retain(|it| !self.is_own(*it) && self.mates.alive.contains(it));
        let leaving = leaving(&wanted, &before);
        let elsewhere = |it: &&Placement| robots.contains(&it.robot);
        let asked: Vec<Placement> = leaving.iter().filter(elsewhere).copied().collect();
        let mut waiting: Vec<RobotIndex> = asked.iter().map(|it| it.robot).collect();
        waiting.dedup();
        let step = Step {
            decision: request.decision,
            number: request.number,
            part: 0,
        };
        let memories = leaving.iter().filter_map(|it| {
            let memory = self.own.memory(*it, lane)?;
            Some((it.component, Bytes(memory)))
        });
        self.change = Some(TeamChange {
            memories: memories.collect(),
            step,
            wanted,
            before,
            robots,
            stage: Stage::Remembering,
            waiting: waiting.clone(),
            failure: None,
        });
        for robot in waiting {
            let its = asked.iter().filter(|it| it.robot == robot);
            let placements = its.map(|it| (it.component, it.robot)).collect();
            self.tell(robot, TaskContent::Remember { step, placements });
        }
        self.go_through_stages(lane);
    }

    /// Goes from stage to stage where nobody is waited for.
    fn go_through_stages(&mut self, lane: &Lane) {
        while let Some(change) = &mut self.change
            && change.waiting.is_empty()
            && change.stage != Stage::Switching
        {
            if change.stage == Stage::Remembering {
                change.stage = Stage::Beginning;
                change.waiting.clone_from(&change.robots);
                let begin = TaskContent::Begin {
                    step: change.step,
                    wanted: placed(&change.wanted),
                    before: placed(&change.before),
                    memories: change.memories.clone(),
                };
                for robot in change.robots.clone() {
                    self.tell(robot, begin.clone());
                }
                continue;
            }
            change.stage = Stage::Switching;
            change.waiting.clone_from(&change.robots);
            let memories = change.memories.iter();
            let memories: Vec<_> = memories.map(|(of, it)| (*of, it.0.clone())).collect();
            let (wanted, before) = (change.wanted.clone(), change.before.clone());
            let begun = self.own.begin_change(&wanted, &before, &memories, lane);
            if let (Err(reason), Some(change)) = (begun, &mut self.change) {
                change.failure = Some(reason);
            }
        }
    }

    /// Another robot has done its part of a change, or cannot.
    pub(super) fn take_progress(&mut self, robot: RobotIndex, content: TaskContent, lane: &Lane) {
        let (step, stage) = match &content {
            TaskContent::Memories { step, .. } => (*step, Some(Stage::Remembering)),
            TaskContent::Begun { step } => (*step, Some(Stage::Beginning)),
            TaskContent::Switched { step } => (*step, Some(Stage::Switching)),
            TaskContent::Failed { step, .. } => (*step, None),
            _ => return,
        };
        let Some(change) = self.change.as_mut().filter(|it| it.step == step) else {
            return;
        };
        match content {
            TaskContent::Failed { reason, .. } => {
                let name = &self.own.binding.task.robots[robot].name;
                change.failure = Some(format!("{name}: {reason}"));
            }
            TaskContent::Memories { memories, .. } => change.memories.extend(memories),
            _ => {}
        }
        if stage == Some(change.stage) {
            change.waiting.retain(|it| *it != robot);
        }
        self.go_through_stages(lane);
    }

    /// Whether a change is under way: then it wants to go on soon.
    pub fn is_changing(&self) -> bool {
        self.change.is_some() || self.following.is_some()
    }

    /// Goes on with a change that is under way, and answers.
    pub fn go_on(&mut self, lane: &Lane) -> Option<Observation> {
        self.own.hear();
        let change = self.change.as_mut()?;
        let (decision, number) = (change.step.decision, change.step.number);
        let mut robots = change.robots.iter();
        if let Some(dead) = robots.find(|it| !self.mates.alive.contains(it)) {
            let name = &self.own.binding.task.robots[*dead].name;
            change.failure.get_or_insert(format!("{name} is dead"));
        }
        if change.stage == Stage::Switching && change.failure.is_none() {
            match self.own.advance(lane) {
                Progress::UnderWay => return None,
                Progress::Switched => {}
                Progress::Failed(reason) => change.failure = Some(reason),
            }
        }
        if let Some(reason) = change.failure.take() {
            self.abandon(lane);
            return Some(Observation::ReconfigurationFailed {
                decision,
                number,
                reason,
            });
        }
        if change.stage != Stage::Switching || !change.waiting.is_empty() {
            return None;
        }
        let wanted = change.wanted.clone();
        let is_good = self.evaluate(&wanted).is_some_and(|answer| {
            let (quality, rejections) = judge(&self.own.binding.task, &wanted, &answer);
            quality.is_some() && rejections.is_empty()
        });
        if !is_good {
            return None;
        }
        self.own.finish(lane);
        if let Some(change) = self.change.take() {
            let finish = TaskContent::Finish { step: change.step };
            for robot in change.robots {
                self.tell(robot, finish.clone());
            }
        }
        self.actual = wanted;
        Some(Observation::Reconfigured { decision, number })
    }

    /// Gives the change up that is under way; what ran before goes on, here and elsewhere.
    pub fn abandon(&mut self, lane: &Lane) {
        self.own.go_back(lane);
        if let Some(change) = self.change.take() {
            let back = TaskContent::GoBack { step: change.step };
            for robot in change.robots {
                self.tell(robot, back.clone());
            }
        }
    }
}

/// Of what ran, those whose component shall run on another robot.
fn leaving(wanted: &[Placement], before: &[Placement]) -> Vec<Placement> {
    let leaves = |placement: &&Placement| {
        let mut wanted = wanted.iter();
        wanted.any(|it| it.component == placement.component && it.robot != placement.robot)
    };
    before.iter().filter(leaves).copied().collect()
}
