//! The one who decides has candidates estimated, here and elsewhere: from robot to robot, as data flow.

use robot_network::task::{Bytes, EstimateRequest, LinkDatum, Number, Placed, Step, TaskContent};
use system_model::task::{Placement, RobotIndex};
use task_adaptation::{Answer, Observation};

use super::estimation::{Rehearsed, Written};
use super::outlet::Heard;
use super::rehearsal::Rehearsal;
use super::team::{Request, Team, placed};
use crate::lane::Lane;

/// An estimate that waits for another robot.
pub struct OpenRehearsal {
    /// The step that is waited for.
    pub(super) step: Step,
    candidate: Vec<Placement>,
    plan: Rehearsal,
    rehearsed: Rehearsed,
}

impl Team {
    /// Has a candidate's estimators run for their cycles.
    pub fn estimate(&mut self, request: Request<'_>, lane: &Lane) -> Option<Observation> {
        let candidate = request.candidate.placements.clone();
        let is_there = |robot: &RobotIndex| self.is_own(*robot) || self.reports[*robot].is_some();
        let mut robots = candidate.iter().map(|it| it.robot);
        let step = Step {
            decision: request.decision,
            number: request.number,
            part: 0,
        };
        if let Some(robot) = robots.find(|robot| !is_there(robot)) {
            let name = &self.own.binding.task.robots[robot].name;
            let answer = Answer::Crashed(format!("{name} is not connected"));
            return Some(estimated(step, answer));
        }
        let open = OpenRehearsal {
            plan: self.own.rehearsal(&candidate, request.running),
            candidate,
            step,
            rehearsed: Rehearsed::default(),
        };
        self.rehearse_on(open, lane)
    }

    /// Goes on with an estimate, until another robot has its turn or it is done.
    fn rehearse_on(&mut self, mut open: OpenRehearsal, lane: &Lane) -> Option<Observation> {
        while let Some(segment) = open.plan.segments.get(open.step.part) {
            if let Some(robot) = segment.robot {
                let datum = |it: &Written| LinkDatum {
                    link: it.link,
                    from: (it.from.component, it.from.robot),
                    bytes: Bytes(it.heard.bytes.clone()),
                };
                let tell = segment.tell.iter();
                let request = EstimateRequest {
                    step: open.step,
                    candidate: placed(&open.candidate),
                    run: placed(&segment.placements),
                    data: open.rehearsed.written.iter().map(datum).collect(),
                    tell: tell
                        .map(|(link, from)| (*link, (from.component, from.robot)))
                        .collect(),
                };
                self.open.push(open);
                self.tell(robot, TaskContent::Estimate(request));
                return None;
            }
            self.rehearsing = Some((None, open.step));
            let given = &open.rehearsed.written;
            let done = self.own.rehearse(segment, &open.plan.wanted, given, lane);
            self.rehearsing = None;
            match done {
                Ok(done) => {
                    open.rehearsed.errors.extend(done.errors);
                    open.rehearsed.written.extend(done.written);
                }
                Err(how) => return Some(estimated(open.step, Answer::Crashed(how))),
            }
            open.step.part += 1;
        }
        let measured = |placement| self.measured_error(placement);
        let (plan, errors) = (&open.plan, &open.rehearsed.errors);
        let performances = self.own.estimated(&open.candidate, plan, errors, measured);
        Some(estimated(open.step, Answer::Performances(performances)))
    }

    /// The error of a component that runs, here or elsewhere; none where nothing tells it.
    fn measured_error(&self, placement: Placement) -> Option<f64> {
        if self.is_own(placement.robot) {
            return self.own.measured_error(placement);
        }
        let report = self.reports[placement.robot].as_ref()?;
        let mut told = report.performances.iter();
        let (_, error, _) = told.find(|(of, ..)| *of == placement.component)?;
        Some(f64::from(*error))
    }

    /// Another robot has done its part of an estimate.
    pub(super) fn take_estimate(
        &mut self,
        step: Step,
        done: Result<Rehearsed, String>,
        lane: &Lane,
    ) -> Option<Observation> {
        let position = self.open.iter().position(|it| it.step == step)?;
        let mut open = self.open.swap_remove(position);
        match done {
            Ok(done) => {
                open.rehearsed.errors.extend(done.errors);
                open.rehearsed.written.extend(done.written);
                open.step.part += 1;
                self.rehearse_on(open, lane)
            }
            Err(how) => Some(estimated(step, Answer::Crashed(how))),
        }
    }
}

fn estimated(step: Step, answer: Answer) -> Observation {
    Observation::Estimated {
        decision: step.decision,
        number: step.number,
        answer,
    }
}

/// What another robot has told of its part of an estimate.
pub(super) fn told(
    team: &Team,
    errors: Vec<(Placed, Option<Number>)>,
    data: Vec<LinkDatum>,
    failure: Option<String>,
) -> Result<Rehearsed, String> {
    if let Some(failure) = failure {
        return Err(failure);
    }
    let mut rehearsed = Rehearsed::default();
    for (of, error) in errors {
        let [placement] = team.placements(&[of]).unwrap_or_default()[..] else {
            return Err("it speaks of components that it has not".to_owned());
        };
        rehearsed.errors.push((placement, error.map(f64::from)));
    }
    rehearsed.written = written(team, data).ok_or("it has sent data of a foreign task")?;
    Ok(rehearsed)
}

/// Data that another robot has sent for an estimate; none if they are of no component of the task.
pub(super) fn written(team: &Team, data: Vec<LinkDatum>) -> Option<Vec<Written>> {
    let stamp_ns = team.own.now_ns();
    let data = data.into_iter().map(|datum| {
        let placements = team.placements(&[datum.from])?;
        Some(Written {
            link: datum.link,
            from: *placements.first()?,
            heard: Heard {
                stamp_ns,
                incarnation: 1,
                bytes: datum.bytes.0,
            },
        })
    });
    data.collect()
}
