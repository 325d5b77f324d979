//! The emergency stop: at once, latched, and what waits until an operator clears it.

use std::collections::BTreeSet;
use std::time::Duration;

use crate::life::Wait;
use crate::manager::FaultManager;
use crate::observation::ActionOutcome;
use crate::plan::{Action, ActionId, Effect};
use crate::stopping::STOP_DEADLINE;
use crate::verdict::{FaultId, FaultState};
use crate::wording;

/// A latched emergency stop.
#[derive(Debug, Default)]
pub(crate) struct Emergency {
    /// Faults that asked for it and have not been cleared.
    behind: BTreeSet<FaultId>,
    /// The action that is under way.
    stop: Option<Stop>,
    /// Whether it was carried out.
    in_force: bool,
}

#[derive(Debug)]
struct Stop {
    id: ActionId,
    fault: FaultId,
    deadline: Duration,
}

impl Emergency {
    /// When the action under way is overdue.
    pub fn deadline(&self) -> Option<Duration> {
        self.stop.as_ref().map(|stop| stop.deadline)
    }

    /// Whether a fault is one of those that asked for it.
    pub fn is_behind(&self, id: FaultId) -> bool {
        self.behind.contains(&id)
    }
}

impl FaultManager {
    /// Stops the robot, unless it stands still already. A fault whose component is in ERROR waits
    /// until an operator lets the robot go on.
    pub(crate) fn raise_emergency(&mut self, id: FaultId) {
        let emergency = self.emergency.get_or_insert_default();
        let new = emergency.behind.insert(id);
        let standing = emergency.in_force || emergency.stop.is_some();
        if let Some(fault) = self.history.get_mut(id)
            && !fault.runs
            && self.components[fault.component].down.is_none()
        {
            fault.waits = Some(Wait::Clearance);
        }
        if !standing {
            self.plan(id, wording::action(&self.system, &Action::EmergencyStop));
            let deadline = self.now.saturating_add(STOP_DEADLINE);
            let number = self.act(id, Action::EmergencyStop, self.now, deadline);
            if let Some(emergency) = self.emergency.as_mut() {
                emergency.stop = Some(Stop {
                    id: number,
                    fault: id,
                    deadline,
                });
            }
        } else if new {
            self.plan(id, wording::IN_FORCE.to_owned());
            self.end_if_idle(id);
        }
    }

    fn end_if_idle(&mut self, id: FaultId) {
        let idle = self.history.get(id);
        if idle.is_some_and(|fault| fault.pending == 0 && fault.waits.is_none()) {
            self.finish(id);
        }
    }

    /// If the action is the emergency stop, notes how it ended; it is the last rung and cannot fail
    /// upward, but the next fault that asks for it will have it tried again.
    pub(crate) fn emergency_ended(&mut self, action: ActionId, outcome: &ActionOutcome) -> bool {
        let under_way = self.emergency.as_mut().and_then(|emergency| {
            let stop = emergency.stop.take_if(|stop| stop.id == action)?;
            emergency.in_force = matches!(outcome, ActionOutcome::Done { .. });
            Some(stop)
        });
        let Some(stop) = under_way else {
            return false;
        };
        let (word, note) = match outcome {
            ActionOutcome::Done { note, .. } => ("done", note),
            ActionOutcome::Failed { reason } => ("failed", reason),
        };
        self.note_outcome(stop.fault, stop.id, word, note.clone());
        self.action_over(stop.fault);
        true
    }

    /// An emergency stop whose end is not told in time is on record as such.
    pub(crate) fn emergency_overdue(&mut self, reached: impl Fn(Duration) -> bool) {
        self.abandon_stop("overdue", "not ended before the deadline", reached);
    }

    fn abandon_stop(
        &mut self,
        outcome: &'static str,
        note: &str,
        applies: impl Fn(Duration) -> bool,
    ) {
        let emergency = self.emergency.as_mut();
        let stop = emergency.and_then(|one| one.stop.take_if(|stop| applies(stop.deadline)));
        if let Some(stop) = stop {
            self.effects.push(Effect::Abandon(stop.id));
            self.note_outcome(stop.fault, stop.id, outcome, note.to_owned());
            self.action_over(stop.fault);
        }
    }

    /// An operator ends a fault. Clearing the last one behind an emergency stop ends that too.
    pub(crate) fn clear(&mut self, id: FaultId) {
        let Some(component) = self.history.get(id).map(|fault| fault.component) else {
            return;
        };
        self.components[component].ladder.renew();
        self.clear_one(id);
        let last = |emergency: &Emergency| emergency.behind.is_empty();
        if self.emergency.as_ref().is_some_and(last) {
            self.rearm();
        }
    }

    /// An operator ends all faults, and the emergency stop.
    pub(crate) fn clear_all(&mut self) {
        for state in &mut self.components {
            state.ladder.renew();
        }
        for id in self.history.which(|_| true) {
            self.clear_one(id);
        }
        self.rearm();
    }

    /// A fault that is being handled is not over because an operator says so; it will heal, even if
    /// it was latched.
    fn clear_one(&mut self, id: FaultId) {
        let emergency = self.emergency.as_mut();
        let behind = emergency.is_some_and(|emergency| emergency.behind.remove(&id));
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        let waits_for_root = matches!(fault.waits, Some(Wait::Root(_)));
        match fault.verdict.state {
            FaultState::Cleared => {}
            FaultState::Prefailed => self.history.remove(id),
            _ if !behind && (fault.pending > 0 || waits_for_root) => fault.latched = false,
            FaultState::Confirmed | FaultState::Healed => {
                let gives_up = fault.runs && fault.waits == Some(Wait::Clearance);
                self.set_state(id, FaultState::Cleared);
                if gives_up {
                    self.give_up_waiting(id);
                }
            }
        }
    }

    /// The robot may move again. Nothing that was stopped is started, but what is still in ERROR is
    /// judged anew.
    fn rearm(&mut self) {
        self.abandon_stop("abandoned", "cleared before its end", |_| true);
        if self.emergency.take().is_none() {
            return;
        }
        self.effects.push(Effect::Rearm);
        let waiting = Some(Wait::Clearance);
        for id in self.history.which(|fault| fault.waits == waiting) {
            self.release(id);
        }
    }

    fn release(&mut self, id: FaultId) {
        let Some(fault) = self.history.get_mut(id) else {
            return;
        };
        let state = &self.components[fault.component];
        let taken_care_of = state.down.is_some() || state.work.is_some();
        if taken_care_of || fault.waits.is_none() {
            self.give_up_waiting(id);
        } else if !fault.runs {
            self.judge_anew(id);
        } else {
            fault.waits = None;
            self.decide(id);
        }
    }
}
