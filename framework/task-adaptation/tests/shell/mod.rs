//! A shell around a decider that checks what it is asked for.

use std::time::Duration;

use system_model::task::{Placement, TaskSpecification};
use task_adaptation::{
    Answer, ComponentPerformance, Decider, Effect, Observation, Outcome, Verdict, generate, judge,
};

use crate::support::chain;

/// Of the tasks in these tests.
pub const DWELL: Duration = Duration::from_secs(10);

/// Three components in a chain and one that may be added, on two robots that have all of them.
pub fn task() -> TaskSpecification {
    let mut task = chain(2, 3, 1, 10.0);
    task.decision.dwell = DWELL;
    task
}

/// The essential components on one robot.
pub fn on(robot: usize, task: &TaskSpecification) -> Vec<Placement> {
    let components = task.components.iter().enumerate();
    let essential = components.filter(|(_, component)| component.is_essential);
    essential
        .map(|(component, _)| Placement { component, robot })
        .collect()
}

fn answer(placements: &[Placement], error: f64) -> Answer {
    let performance = ComponentPerformance {
        functional: error,
        use_of_resources: vec![1.0],
    };
    Answer::Performances(vec![performance; placements.len()])
}

/// How a shell behaves in one step.
#[derive(Debug, Clone)]
pub enum Step {
    Evaluate(f64),
    Request,
    Wait(u16),
    /// A robot loses everything, or gets it again.
    Robot(usize, bool),
    /// Answers one open question, if there is one: with an error, a crash, or a failure.
    Answer(f64, bool),
}

/// A shell that remembers what was asked and checks what it is asked for.
pub struct Shell {
    pub decider: Decider,
    pub now: Duration,
    pub open: Vec<Effect>,
    /// What was told about each candidate of the present decision.
    told: Vec<(usize, Answer)>,
    changes: Vec<Duration>,
    /// Since the last change.
    lost: bool,
    pub verdicts: Vec<Verdict>,
}

impl Shell {
    pub fn new() -> Self {
        let task = task();
        let running = on(0, &task);
        Self {
            decider: Decider::new(task, running),
            now: Duration::ZERO,
            open: Vec::new(),
            told: Vec::new(),
            changes: Vec::new(),
            lost: false,
            verdicts: Vec::new(),
        }
    }

    pub fn tell(&mut self, observation: Observation) {
        let effects = self.decider.observe(observation, self.now);
        for effect in effects {
            match effect {
                Effect::Synthesise { .. } => {
                    self.told.clear();
                    self.open = vec![effect];
                }
                Effect::Abandon { .. } => self.open.clear(),
                Effect::Decided(verdict) => {
                    self.open.clear();
                    self.check(&verdict);
                    self.verdicts.push(*verdict);
                }
                Effect::Reconfigure {
                    number,
                    ref candidate,
                    ..
                } => {
                    self.check_feasible(number, &candidate.placements);
                    self.open = vec![effect];
                }
                Effect::Estimate { .. } => self.open.push(effect),
            }
        }
    }

    fn check_feasible(&self, number: usize, placements: &[Placement]) {
        let task = self.decider.task();
        assert!(placements.iter().all(|it| task.instance(*it).is_some()));
        // Unless it was measured as what runs, its estimators must have spoken for it.
        let told = self.told.iter().find(|(other, _)| *other == number);
        if let Some((_, answer)) = told {
            let (quality, rejections) = judge(task, placements, answer);
            assert!(quality.is_some() && rejections.is_empty(), "{answer:?}");
        } else {
            assert!(placements.len() == self.decider.running().len());
        }
    }

    fn check(&mut self, verdict: &Verdict) {
        assert_eq!(verdict.decision, self.verdicts.len() as u64 + 1);
        let Outcome::Changed(number) = verdict.outcome else {
            let is_end = !matches!(verdict.outcome, Outcome::Kept(_));
            for judged in verdict.candidates.iter().filter(|_| is_end) {
                assert!(
                    !judged.is_feasible && !judged.rejections.is_empty(),
                    "{judged:?}"
                );
            }
            return;
        };
        for judged in &verdict.candidates {
            assert_eq!(
                judged.rejections.is_empty(),
                judged.number == number,
                "{judged:?}"
            );
        }
        if let Some(last) = self.changes.last().filter(|_| !self.lost) {
            assert!(self.now - *last >= DWELL, "{last:?} {:?}", self.now);
        }
        self.changes.push(self.now);
        // What came to run may have lost an instance while it was brought about.
        let task = self.decider.task();
        let mut running = self.decider.running().iter();
        self.lost = running.any(|it| task.instance(*it).is_none());
    }

    pub fn step(&mut self, step: &Step) {
        match step {
            Step::Evaluate(error) => {
                let answer = answer(self.decider.running(), *error);
                self.tell(Observation::Evaluated(answer));
            }
            Step::Request => self.tell(Observation::Requested),
            Step::Wait(milliseconds) => {
                self.now += Duration::from_millis(u64::from(*milliseconds));
                self.tell(Observation::TimePassed);
            }
            Step::Robot(robot, is_there) => {
                let mut changed = self.decider.task().clone();
                changed.robots[*robot] = task().robots[*robot].clone();
                if !is_there {
                    changed.robots[*robot].instances.clear();
                }
                self.lost |= !is_there;
                self.tell(Observation::TaskChanged(Box::new(changed)));
            }
            Step::Answer(error, fails) => self.answer(*error, *fails),
        }
    }

    pub fn answer(&mut self, error: f64, fails: bool) {
        let Some(question) = self.open.pop() else {
            return;
        };
        let observation = match question {
            Effect::Synthesise { decision } => {
                let result = generate(self.decider.task(), Some(self.decider.running()));
                Observation::Synthesised { decision, result }
            }
            Effect::Estimate {
                decision,
                number,
                candidate,
            } => {
                let answer = match fails {
                    true => Answer::Crashed("SIGSEGV".into()),
                    false => answer(&candidate.placements, error),
                };
                self.told.push((number, answer.clone()));
                Observation::Estimated {
                    decision,
                    number,
                    answer,
                }
            }
            Effect::Reconfigure {
                decision, number, ..
            } => match fails {
                true => Observation::ReconfigurationFailed {
                    decision,
                    number,
                    reason: "its library is gone".into(),
                },
                false => Observation::Reconfigured { decision, number },
            },
            Effect::Abandon { .. } | Effect::Decided(_) => return,
        };
        self.tell(observation);
    }
}
