//! What robots do that do not decide: they estimate and change as they are asked, and take over what
//! runs.

use robot_network::task::{Bytes, EstimateRequest, LinkDatum, Step, TaskContent, TaskMessage};
use system_model::task::{Placement, RobotIndex};
use task_adaptation::Observation;

use super::asking::{told, written};
use super::change::Progress;
use super::rehearsal::Segment;
use super::team::{News, Team};
use super::wiring::hops;
use crate::lane::Lane;

/// A change on behalf of the one who decides.
pub struct Following {
    /// Who is told how it goes; nobody where what runs is taken over.
    order: Option<(RobotIndex, Step)>,
    /// What shall run.
    pub(super) wanted: Vec<Placement>,
    has_switched: bool,
}

impl Team {
    /// Takes what another robot has told.
    pub(super) fn take(
        &mut self,
        robot: RobotIndex,
        message: TaskMessage,
        news: &mut News,
        lane: &Lane,
    ) {
        let (term, incarnation) = (message.term, message.incarnation);
        match message.content {
            TaskContent::Report(report) => self.take_report(robot, report),
            TaskContent::Estimated {
                step,
                errors,
                data,
                failure,
            } => {
                let name = self.own.binding.task.robots[robot].name.clone();
                let done = told(self, errors, data, failure);
                let done = done.map_err(|how| format!("{name}: {how}"));
                news.answers.extend(self.take_estimate(step, done, lane));
            }
            content @ (TaskContent::Memories { .. }
            | TaskContent::Begun { .. }
            | TaskContent::Switched { .. }
            | TaskContent::Failed { .. }) => self.take_progress(robot, content, lane),
            content => {
                let orders = self.own.binding.task.robots[robot].name.clone();
                let decides = self.mates.decider.is_none_or(|decider| decider == robot);
                if !decides {
                    return;
                }
                match self.fence.admit(term, &orders, incarnation) {
                    Ok(()) => self.obey(robot, content, news, lane),
                    Err(refused) => self.own.notice(&format!("task: {refused}")),
                }
            }
        }
    }

    fn obey(&mut self, robot: RobotIndex, content: TaskContent, news: &mut News, lane: &Lane) {
        match content {
            TaskContent::Running {
                placements,
                decided,
            } => {
                news.running = self.placements(&placements).or(news.running.take());
                news.decided = decided.or(news.decided.take());
            }
            TaskContent::Estimate(request) => self.estimate_for(robot, request, lane),
            TaskContent::Remember { step, placements } => {
                let placements = self.placements(&placements).unwrap_or_default();
                let memories = placements.into_iter().filter_map(|it| {
                    let memory = self.own.memory(it, lane)?;
                    Some((it.component, Bytes(memory)))
                });
                let memories = memories.collect();
                self.tell(robot, TaskContent::Memories { step, memories });
            }
            TaskContent::Begin {
                step,
                wanted,
                before,
                memories,
            } => {
                let wanted = self.placements(&wanted);
                let before = self.placements(&before);
                let (Some(wanted), Some(before)) = (wanted, before) else {
                    let reason = "it is asked for components that it has not".to_owned();
                    return self.tell(robot, TaskContent::Failed { step, reason });
                };
                self.stop_following(lane);
                if before != self.actual {
                    let reason = "something else runs there".to_owned();
                    return self.tell(robot, TaskContent::Failed { step, reason });
                }
                let memories = memories.into_iter().map(|(of, it)| (of, it.0));
                let memories: Vec<_> = memories.collect();
                let begun = self.own.begin_change(&wanted, &before, &memories, lane);
                let answer = match begun {
                    Ok(()) => TaskContent::Begun { step },
                    Err(reason) => return self.tell(robot, TaskContent::Failed { step, reason }),
                };
                self.following = Some(Following {
                    order: Some((robot, step)),
                    wanted,
                    has_switched: false,
                });
                self.tell(robot, answer);
            }
            TaskContent::Finish { step } if self.follows(robot, step) => {
                self.own.finish(lane);
                if let Some(following) = self.following.take() {
                    self.actual = following.wanted;
                }
            }
            TaskContent::GoBack { step } if self.follows(robot, step) => self.stop_following(lane),
            _ => {}
        }
    }

    fn follows(&self, robot: RobotIndex, step: Step) -> bool {
        let following = self.following.as_ref();
        following.is_some_and(|it| it.order == Some((robot, step)))
    }

    /// What was begun for the one who decides goes back.
    pub(super) fn stop_following(&mut self, lane: &Lane) {
        if self.following.take().is_some() {
            self.own.go_back(lane);
        }
    }

    fn estimate_for(&mut self, robot: RobotIndex, request: EstimateRequest, lane: &Lane) {
        let step = request.step;
        self.rehearsing = Some((Some(robot), step));
        let done = self.rehearse_for(request, lane);
        self.rehearsing = None;
        let content = done.unwrap_or_else(|how| TaskContent::Estimated {
            step,
            errors: Vec::new(),
            data: Vec::new(),
            failure: Some(how),
        });
        self.tell(robot, content);
    }

    fn rehearse_for(
        &mut self,
        request: EstimateRequest,
        lane: &Lane,
    ) -> Result<TaskContent, String> {
        let foreign = "it is asked about components that it has not";
        let candidate = self.placements(&request.candidate).ok_or(foreign)?;
        let placements = self.placements(&request.run).ok_or(foreign)?;
        let tell = request.tell.iter().map(|(link, from)| {
            let from = self.placements(&[*from])?;
            Some((*link, *from.first()?))
        });
        let segment = Segment {
            robot: None,
            tell: tell.collect::<Option<_>>().ok_or(foreign)?,
            placements,
        };
        let given = written(self, request.data).ok_or(foreign)?;
        let wanted = hops(&self.own.binding.task.links, &candidate);
        let done = self.own.rehearse(&segment, &wanted, &given, lane)?;
        let errors = done.errors.into_iter();
        let data = done.written.into_iter().map(|it| LinkDatum {
            link: it.link,
            from: (it.from.component, it.from.robot),
            bytes: Bytes(it.heard.bytes),
        });
        Ok(TaskContent::Estimated {
            step: request.step,
            errors: errors
                .map(|(of, error)| ((of.component, of.robot), error.map(Into::into)))
                .collect(),
            data: data.collect(),
            failure: None,
        })
    }

    /// What runs is not what this system is connected for: it was away, or has missed something.
    pub(super) fn adopt(&mut self, running: Vec<Placement>, lane: &Lane) {
        if running == self.actual || self.following.is_some() {
            return;
        }
        let before = std::mem::replace(&mut self.actual, running.clone());
        match self.own.begin_change(&running, &before, &[], lane) {
            Ok(()) => {
                self.following = Some(Following {
                    order: None,
                    wanted: running,
                    has_switched: false,
                });
            }
            Err(how) => self
                .own
                .notice(&format!("what runs cannot be taken over: {how}")),
        }
    }

    /// Goes on with a change for another robot.
    pub(super) fn follow_through(&mut self, lane: &Lane) {
        let Some(following) = &mut self.following else {
            return;
        };
        let order = following.order;
        self.own.hear();
        match self.own.advance(lane) {
            Progress::UnderWay => {}
            Progress::Switched => match order {
                None => {
                    self.following = None;
                    self.own.finish(lane);
                }
                Some((robot, step)) if !following.has_switched => {
                    following.has_switched = true;
                    // Whoever decides wants to know how well it does now, too.
                    self.report(false);
                    self.tell(robot, TaskContent::Switched { step });
                }
                Some(_) => {}
            },
            Progress::Failed(reason) => {
                self.following = None;
                match order {
                    Some((robot, step)) => self.tell(robot, TaskContent::Failed { step, reason }),
                    None => self
                        .own
                        .notice(&format!("what runs was not taken over: {reason}")),
                }
            }
        }
    }

    /// The thread was lost in a component that was run for an estimate; what to tell the decider, if it
    /// was for this robot. None if no estimate was under way.
    pub fn after_loss(&mut self) -> Option<Option<Observation>> {
        let how = "its thread was lost in the C library".to_owned();
        let (robot, step) = self.rehearsing.take()?;
        match robot {
            Some(robot) => {
                self.tell(
                    robot,
                    TaskContent::Estimated {
                        step,
                        errors: Vec::new(),
                        data: Vec::new(),
                        failure: Some(how),
                    },
                );
                Some(None)
            }
            None => Some(Some(Observation::Estimated {
                decision: step.decision,
                number: step.number,
                answer: task_adaptation::Answer::Crashed(how),
            })),
        }
    }
}
