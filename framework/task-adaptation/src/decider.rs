//! The decider, section 4 and figure 8: monitor, synthesise, estimate, decide and reconfigure.
//!
//! It reads no clock and does nothing: observations and time go in, effects come out. Whoever carries
//! them out (the shell) answers each effect with an observation, sooner or later or never.
//!
//! * A decision is begun by bad evaluations in a row, by a request, or because what runs has lost
//!   an instance.
//! * Between two changes passes at least the dwell time, and likewise after a decision that changed
//!   nothing; only the loss of an instance does not wait, because then nothing is left that could
//!   waver.
//! * What runs is judged by its evaluators, not by estimates: it has been measured.
//! * A change that fails leaves what ran, and the next best candidate is tried at once, each once.
//! * Answers to a question that is no longer asked are dropped.

mod decision;
mod exchange;

use std::time::Duration;

use system_model::task::{Placement, TaskSpecification};

use crate::estimate::Answer;
use crate::monitor::BadEvaluations;
use crate::verdict::{Outcome, Trigger};
use decision::{Decision, Step};

pub use exchange::{Effect, Observation};

/// The four states of figure 8.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeciderState {
    /// State 1: monitoring and diagnosis.
    Monitoring,
    /// State 2: task solution synthesis.
    Synthesising,
    /// State 3: estimation.
    Estimating,
    /// State 4: final decision and reconfiguration.
    Reconfiguring,
}

/// The decider.
#[derive(Debug)]
pub struct Decider {
    task: TaskSpecification,
    running: Vec<Placement>,
    bad: BadEvaluations,
    evaluated: Option<Answer>,
    /// Somebody has asked, and the dwell time was not over.
    requested: bool,
    decisions: u64,
    /// When the last change or decision in vain was over.
    rests_since: Option<Duration>,
    decision: Option<Decision>,
}

impl Decider {
    /// A decider that monitors `running`.
    pub fn new(task: TaskSpecification, running: Vec<Placement>) -> Self {
        Self {
            task,
            running,
            bad: BadEvaluations::default(),
            evaluated: None,
            requested: false,
            decisions: 0,
            rests_since: None,
            decision: None,
        }
    }

    /// The task as it is known.
    pub fn task(&self) -> &TaskSpecification {
        &self.task
    }

    /// T_cur: what runs.
    pub fn running(&self) -> &[Placement] {
        &self.running
    }

    /// What it is at.
    pub fn state(&self) -> DeciderState {
        let step = self.decision.as_ref().map(|decision| &decision.step);
        step.map_or(DeciderState::Monitoring, Step::state)
    }

    /// When it wants to see [`Observation::TimePassed`] at the latest.
    pub fn deadline(&self) -> Option<Duration> {
        if let Some(decision) = &self.decision {
            return Some(decision.deadline(&self.task));
        }
        let waits = self.requested || self.is_bad() || !self.lost().is_empty();
        self.rests_until().filter(|_| waits)
    }

    /// Takes an observation; `now` is the time of a clock that does not go back.
    pub fn observe(&mut self, observation: Observation, now: Duration) -> Vec<Effect> {
        let mut effects = Vec::new();
        match observation {
            Observation::Evaluated(answer) => {
                self.bad.take(&self.task, &self.running, &answer, now);
                self.evaluated = Some(answer);
            }
            Observation::Requested => self.requested = true,
            Observation::TaskChanged(task) => self.change_task(*task, now, &mut effects),
            Observation::TimePassed => {}
            answer => self.answer(answer, now, &mut effects),
        }
        self.look_at_deadline(now, &mut effects);
        self.begin_if_due(now, &mut effects);
        effects
    }

    /// Another robot decides, and this is what runs: a decision that is under way is overtaken. The
    /// dwell time counts from its changes, too.
    pub fn follow(&mut self, running: Vec<Placement>, now: Duration) -> Vec<Effect> {
        let mut effects = Vec::new();
        if let Some(mut decision) = self.decision.take() {
            decision.step = Step::Over(Outcome::Overtaken);
            self.go_on(decision, now, &mut effects);
        }
        if self.running != running {
            self.running = running;
            self.evaluated = None;
            self.rests_since = Some(now);
        }
        self.bad = BadEvaluations::default();
        effects
    }

    fn change_task(&mut self, task: TaskSpecification, now: Duration, effects: &mut Vec<Effect>) {
        self.task = task;
        let candidates_are_old =
            |decision: &mut Decision| matches!(decision.step, Step::Synthesise | Step::Estimate(_));
        if let Some(mut decision) = self.decision.take_if(candidates_are_old) {
            decision.step = Step::Over(Outcome::Overtaken);
            self.go_on(decision, now, effects);
            // The next decision is the same one, with the robots as they are now.
            self.requested = true;
            self.rests_since = None;
        }
        if self.decision.is_none() && !self.lost().is_empty() {
            self.rests_since = None;
        }
    }

    /// Parts of what runs that are no longer there.
    fn lost(&self) -> Vec<Placement> {
        let running = self.running.iter().copied();
        running
            .filter(|placement| self.task.instance(*placement).is_none())
            .collect()
    }

    fn is_bad(&self) -> bool {
        self.bad.count() >= self.task.decision.confirm.max(1)
    }

    fn rests_until(&self) -> Option<Duration> {
        let since = self.rests_since?;
        Some(since.saturating_add(self.task.decision.dwell))
    }

    fn begin_if_due(&mut self, now: Duration, effects: &mut Vec<Effect>) {
        if self.decision.is_some() || self.rests_until().is_some_and(|until| now < until) {
            return;
        }
        let lost = self.lost();
        let trigger = if !lost.is_empty() {
            Trigger::Lost(lost)
        } else if self.is_bad() {
            Trigger::Evaluated {
                bad_evaluations: self.bad.count(),
            }
        } else if self.requested {
            Trigger::Requested
        } else {
            return;
        };
        self.requested = false;
        self.decisions += 1;
        let since = match trigger {
            Trigger::Evaluated { .. } => self.bad.since(),
            _ => None,
        };
        self.decision = Some(Decision::new(self.decisions, trigger, since, now));
        effects.push(Effect::Synthesise {
            decision: self.decisions,
        });
    }

    fn answer(&mut self, observation: Observation, now: Duration, effects: &mut Vec<Effect>) {
        let Some(mut decision) = self.decision.take() else {
            return;
        };
        let running = Running {
            task: &self.task,
            placements: &self.running,
            evaluated: self.evaluated.as_ref(),
        };
        decision.answer(&running, observation, now, effects);
        self.go_on(decision, now, effects);
    }

    fn look_at_deadline(&mut self, now: Duration, effects: &mut Vec<Effect>) {
        let Some(mut decision) = self.decision.take() else {
            return;
        };
        let running = Running {
            task: &self.task,
            placements: &self.running,
            evaluated: self.evaluated.as_ref(),
        };
        decision.look_at_deadline(&running, now, effects);
        self.go_on(decision, now, effects);
    }

    /// Keeps a decision that goes on; ends one that is over.
    fn go_on(&mut self, decision: Decision, now: Duration, effects: &mut Vec<Effect>) {
        if !matches!(decision.step, Step::Over(_)) {
            self.decision = Some(decision);
            return;
        }
        if let Some(candidate) = decision.changed_to() {
            self.running = candidate.placements.clone();
            self.evaluated = None;
        }
        self.bad = BadEvaluations::default();
        self.requested = false;
        // What came to run may have lost an instance meanwhile.
        let is_whole = decision.changed_to().is_none() || self.lost().is_empty();
        self.rests_since = is_whole.then_some(now);
        effects.push(Effect::Decided(Box::new(decision.into_verdict())));
    }
}

/// What a decision is about.
struct Running<'a> {
    task: &'a TaskSpecification,
    placements: &'a [Placement],
    /// The last that its evaluators said.
    evaluated: Option<&'a Answer>,
}
