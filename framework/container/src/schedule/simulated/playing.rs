//! A recording that is played in simulated time: its messages come between the executors' cycles.

use std::time::Duration;

use super::Simulated;
use crate::component::ComponentCell;
use crate::executor::Executor;
use crate::lane::{Lane, SETUP_TOKEN};
use crate::replay::Score;

/// What of a recording was played.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Played {
    /// Nothing: something else comes before.
    Nothing,
    /// What comes next.
    Some,
    /// There is nothing more.
    All,
}

impl Simulated {
    /// The recording by which an executor goes.
    pub(super) fn score_of(&self, index: usize) -> Option<&Score> {
        let (score, played) = self.played.as_ref()?;
        played[index].then_some(score)
    }

    /// When the next message of the recording comes.
    pub(super) fn cue_ns(&self) -> Option<u64> {
        self.played.as_ref()?.0.next_ns()
    }

    /// Whether everything of the recording was played, and what is next by itself comes after it.
    pub(super) fn is_over(&self, next_ns: Option<u64>) -> bool {
        let over = |score: &Score| {
            score.next_ns().is_none() && next_ns.is_none_or(|next_ns| next_ns > score.last_ns())
        };
        self.played.as_ref().is_some_and(|(score, _)| over(score))
    }

    /// Lets come what the recording has next, unless something else comes before.
    pub(super) fn play(&self, next_ns: Option<u64>, lane: &Lane) -> Played {
        let Some((score, _)) = &self.played else {
            return Played::Nothing;
        };
        if self.is_over(next_ns) {
            return Played::All;
        }
        let Some(cue_ns) = score.next_ns() else {
            return Played::Nothing;
        };
        let now_ns = self.environment.clock.now_ns();
        // What came at this very time comes before the cycles that read and write it.
        if next_ns.is_some_and(|next_ns| next_ns < cue_ns.max(now_ns)) {
            return Played::Nothing;
        }
        if cue_ns > now_ns && !self.advance(cue_ns) {
            return Played::All;
        }
        score.release(self.environment.clock.now_ns(), lane.token());
        Played::Some
    }
}

/// Whether all components of an executor are played.
pub(super) fn is_played(executor: &Executor, score: &Score) -> bool {
    let plays = |cell: &ComponentCell| {
        let component = cell.enter(SETUP_TOKEN, Duration::ZERO);
        component.is_some_and(|component| score.plays(component.name()))
    };
    executor
        .members
        .iter()
        .all(|member| plays(&member.component))
}
