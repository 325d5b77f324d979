//! What robots tell each other of themselves: what they have, and how well they do.

use std::time::Duration;

use robot_network::task::{Number, RobotReport, TaskContent};
use system_model::task::{Placement, RobotIndex, TaskSpecification};
use task_adaptation::Answer;

use super::team::Team;
use crate::lane::Lane;

/// How often robots tell each other how they do where nothing is new, and what runs: a few times
/// within the limit of silence.
const TELL_PERIOD: Duration = Duration::from_millis(100);

impl Team {
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
}
