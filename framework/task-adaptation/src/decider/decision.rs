//! One decision from its trigger to its end: states 2 to 4.

use std::time::Duration;

use system_model::task::{Placement, TaskSpecification};

use super::{DeciderState, Effect, Observation, Running};
use crate::estimate::{Answer, reordered};
use crate::generator::{Candidate, Generation, Room};
use crate::judge::{Choice, choose, judge_all, nearest};
use crate::verdict::{GenerationFailure, Outcome, Rejection, Trigger, Verdict};

/// The generator is bounded to less than a second; a shell that has not called it by then never will.
const SYNTHESIS_DEADLINE: Duration = Duration::from_secs(5);

/// Where a decision is.
#[derive(Debug)]
pub(super) enum Step {
    /// State 2.
    Synthesise,
    /// State 3: the answers so far, by candidate.
    Estimate(Vec<Option<Answer>>),
    /// State 4: the number of the candidate that is being brought about.
    Reconfigure(usize),
    /// It has ended.
    Over(Outcome),
}

/// One decision.
#[derive(Debug)]
pub(super) struct Decision {
    pub(super) step: Step,
    verdict: Verdict,
    candidates: Vec<Candidate>,
    /// When the step was begun; of several changes the last one.
    since: Duration,
    /// When the first change was begun.
    changing_since: Option<Duration>,
}

impl Step {
    pub(super) fn state(&self) -> DeciderState {
        match self {
            Self::Synthesise => DeciderState::Synthesising,
            Self::Estimate(_) => DeciderState::Estimating,
            Self::Reconfigure(_) => DeciderState::Reconfiguring,
            Self::Over(_) => DeciderState::Monitoring,
        }
    }
}

impl Decision {
    /// A decision that begins; `bad_since` is the first bad evaluation, if that is the reason.
    pub(super) fn new(
        number: u64,
        trigger: Trigger,
        bad_since: Option<Duration>,
        now: Duration,
    ) -> Self {
        let monitoring = bad_since.map_or(Duration::ZERO, |since| now.saturating_sub(since));
        Self {
            step: Step::Synthesise,
            verdict: Verdict::begun(number, trigger, monitoring),
            candidates: Vec::new(),
            since: now,
            changing_since: None,
        }
    }

    /// When the present step has taken too long.
    pub(super) fn deadline(&self, task: &TaskSpecification) -> Duration {
        self.since.saturating_add(self.limit(task))
    }

    fn limit(&self, task: &TaskSpecification) -> Duration {
        match self.step {
            Step::Synthesise => SYNTHESIS_DEADLINE,
            Step::Estimate(_) => task.decision.estimation_deadline,
            Step::Reconfigure(_) => task.decision.reconfiguration_deadline,
            Step::Over(_) => Duration::ZERO,
        }
    }

    /// Takes an answer of the shell, if it is to the question that is being asked.
    pub(super) fn answer(
        &mut self,
        running: &Running<'_>,
        observation: Observation,
        now: Duration,
        effects: &mut Vec<Effect>,
    ) {
        let own = self.verdict.decision;
        match (&mut self.step, observation) {
            (Step::Synthesise, Observation::Synthesised { decision, result })
                if decision == own =>
            {
                match result {
                    Ok(generation) => self.take_candidates(running, generation, now, effects),
                    Err(error) => self.fail(GenerationFailure::Refused(error)),
                }
            }
            (
                Step::Estimate(answers),
                Observation::Estimated {
                    decision,
                    number,
                    answer,
                },
            ) if decision == own => {
                let slot = answers.get_mut(number.wrapping_sub(1));
                if let Some(slot @ None) = slot {
                    *slot = Some(answer);
                }
                self.decide_if_complete(running, now, effects);
            }
            (Step::Reconfigure(chosen), Observation::Reconfigured { decision, number })
                if (decision, number) == (own, *chosen) =>
            {
                self.verdict.phases.reconfiguration = self.changing(now);
                self.step = Step::Over(Outcome::Changed(number));
            }
            (
                Step::Reconfigure(chosen),
                Observation::ReconfigurationFailed {
                    decision,
                    number,
                    reason,
                },
            ) if (decision, number) == (own, *chosen) => {
                self.try_next(running, number, reason, now, effects);
            }
            // An answer to a question that is no longer asked.
            _ => {}
        }
    }

    /// Ends a step that has taken too long.
    pub(super) fn look_at_deadline(
        &mut self,
        running: &Running<'_>,
        now: Duration,
        effects: &mut Vec<Effect>,
    ) {
        if now < self.deadline(running.task) {
            return;
        }
        let limit = self.limit(running.task);
        match &mut self.step {
            Step::Synthesise => {
                self.verdict.phases.synthesis = now.saturating_sub(self.since);
                self.fail(GenerationFailure::Silent(limit));
            }
            Step::Estimate(answers) => {
                for answer in answers.iter_mut() {
                    answer.get_or_insert(Answer::Silent(limit));
                }
                self.decide_if_complete(running, now, effects);
            }
            Step::Reconfigure(number) => {
                let number = *number;
                effects.push(Effect::Abandon {
                    decision: self.verdict.decision,
                    number,
                });
                let reason = format!("it was not done after {limit:?}");
                self.try_next(running, number, reason, now, effects);
            }
            Step::Over(_) => {}
        }
    }

    fn fail(&mut self, failure: GenerationFailure) {
        self.step = Step::Over(Outcome::NotGenerated(failure));
    }

    /// From state 2 to 3: every candidate that the robots have room for is estimated.
    fn take_candidates(
        &mut self,
        running: &Running<'_>,
        generation: Generation,
        now: Duration,
        effects: &mut Vec<Effect>,
    ) {
        self.verdict.phases.synthesis = now.saturating_sub(self.since);
        self.verdict.combinations = generation.combinations;
        self.verdict.groups = generation.groups;
        self.verdict.left_out = generation.left_out;
        self.verdict.lacking = generation.lacking;
        self.candidates = generation.candidates;
        self.since = now;
        let mut answers = Vec::with_capacity(self.candidates.len());
        for (index, candidate) in self.candidates.iter().enumerate() {
            let runs = candidate.is_made_of(running.placements);
            let measured = running
                .evaluated
                .filter(|answer| runs && matches!(answer, Answer::Performances(_)));
            let answer = match (&candidate.room, measured) {
                (_, Some(answer)) => {
                    let placements = &candidate.placements;
                    Some(reordered(answer, running.placements, placements))
                }
                (Room::Enough | Room::EnoughHere, None) => None,
                _ => Some(Answer::NotAsked),
            };
            if answer.is_none() {
                effects.push(Effect::Estimate {
                    decision: self.verdict.decision,
                    number: index + 1,
                    candidate: candidate.clone(),
                });
            }
            answers.push(answer);
        }
        self.step = Step::Estimate(answers);
        self.decide_if_complete(running, now, effects);
    }

    /// From state 3 to 4, when all answers are there.
    fn decide_if_complete(
        &mut self,
        running: &Running<'_>,
        now: Duration,
        effects: &mut Vec<Effect>,
    ) {
        let Step::Estimate(answers) = &self.step else {
            return;
        };
        let Some(answers) = answers.iter().cloned().collect::<Option<Vec<Answer>>>() else {
            return;
        };
        self.verdict.phases.estimation = now.saturating_sub(self.since);
        self.verdict.candidates = judge_all(running.task, &self.candidates, &answers);
        self.decide(running, now, effects);
    }

    fn decide(&mut self, running: &Running<'_>, now: Duration, effects: &mut Vec<Effect>) {
        let judged = &mut self.verdict.candidates;
        self.step = match choose(running.task, judged, Some(running.placements)) {
            Choice::Take(number) => {
                effects.push(Effect::Reconfigure {
                    decision: self.verdict.decision,
                    number,
                    candidate: judged[number - 1].candidate.clone(),
                });
                self.since = now;
                self.changing_since.get_or_insert(now);
                Step::Reconfigure(number)
            }
            Choice::Keep(number) => Step::Over(Outcome::Kept(number)),
            Choice::Nothing => {
                self.verdict.nearest = nearest(running.task, judged);
                Step::Over(Outcome::NoCandidate)
            }
        };
    }

    /// What could not be brought about is no candidate any more.
    fn try_next(
        &mut self,
        running: &Running<'_>,
        failed: usize,
        reason: String,
        now: Duration,
        effects: &mut Vec<Effect>,
    ) {
        let is_there = |placement: &Placement| running.task.instance(*placement).is_some();
        for judged in &mut self.verdict.candidates {
            if judged.number == failed {
                judged.is_feasible = false;
                judged.rejections = vec![Rejection::ChangeFailed(reason.clone())];
            } else if !judged.candidate.placements.iter().all(is_there) {
                judged.is_feasible = false;
                judged.rejections = vec![Rejection::Lost];
            } else if judged.is_feasible {
                judged.rejections.clear();
            }
        }
        self.verdict.phases.reconfiguration = self.changing(now);
        self.decide(running, now, effects);
    }

    fn changing(&self, now: Duration) -> Duration {
        let since = self.changing_since;
        since.map_or(Duration::ZERO, |since| now.saturating_sub(since))
    }

    /// The candidate that runs now, if the decision has ended with a change.
    pub(super) fn changed_to(&self) -> Option<&Candidate> {
        match self.step {
            Step::Over(Outcome::Changed(number)) => self.candidates.get(number - 1),
            _ => None,
        }
    }

    /// What goes on record.
    pub(super) fn into_verdict(self) -> Verdict {
        let mut verdict = self.verdict;
        if let Step::Over(outcome) = self.step {
            verdict.outcome = outcome;
        }
        verdict
    }
}
