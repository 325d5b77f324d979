//! The shell: what is heard becomes observations of the decider, what it asks for is done, each
//! decision goes on record.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use fault_manager::{ActionId, ActionOutcome};
use task_adaptation::{Answer, Decider, DeciderState, Effect, Observation, Outcome, generate};

use super::performer::{Performer, Request};
use super::record::AdaptationRecord;
use crate::clock::nanoseconds;
use crate::component::Environment;
use crate::event_log::Event;
use crate::lane::Lane;

/// How often a change that is under way is looked at: a fraction of any period of a robot's data.
const CHANGE_PERIOD: Duration = Duration::from_millis(1);

/// One task that is watched over.
pub struct Adaptation {
    decider: Decider,
    performer: Box<dyn Performer>,
    environment: Arc<Environment>,
    /// What is to be done; kept here and not on a stack that may be lost.
    effects: VecDeque<Effect>,
    /// The estimate that is under way: decision and candidate.
    estimating: Option<(u64, usize)>,
    /// When what runs is evaluated next, in nanoseconds.
    evaluates_ns: u64,
    /// What the fault manager waits for: components, and its actions.
    asked: Vec<(usize, ActionId)>,
}

impl Adaptation {
    /// Watches over a task; nothing of it runs yet.
    pub fn new(
        decider: Decider,
        performer: Box<dyn Performer>,
        environment: Arc<Environment>,
    ) -> Self {
        Self {
            decider,
            performer,
            environment,
            effects: VecDeque::new(),
            estimating: None,
            evaluates_ns: 0,
            asked: Vec::new(),
        }
    }

    /// When it wants to look next, in nanoseconds of the container's clock.
    pub fn due_ns(&self) -> u64 {
        let requests = &self.environment.adaptation_requests;
        if !self.effects.is_empty() || requests.any(|component| self.performer.owns(component)) {
            return 0;
        }
        let decider = self.decider.deadline().map_or(u64::MAX, nanoseconds);
        let due_ns = self.evaluates_ns.min(decider);
        match self.performer.is_changing() {
            true => due_ns.min(self.environment.clock.now_ns() + nanoseconds(CHANGE_PERIOD)),
            false => due_ns,
        }
    }

    /// Looks, and does what is due. Runs code of components.
    pub fn look(&mut self, lane: &Lane) {
        self.take_requests();
        self.work_off(lane);
        let now = self.environment.clock.now();
        if nanoseconds(now) >= self.evaluates_ns {
            let period_ns = nanoseconds(self.decider.task().decision.evaluation_period);
            self.evaluates_ns = (nanoseconds(now) / period_ns + 1) * period_ns;
            self.evaluate(lane);
            self.work_off(lane);
        }
        if self
            .decider
            .deadline()
            .is_some_and(|deadline| deadline <= now)
        {
            self.observe(Observation::TimePassed);
            self.work_off(lane);
        }
        while let Some(answer) = self.performer.go_on(lane) {
            self.observe(answer);
            self.work_off(lane);
        }
    }

    /// The lane's thread was lost in code of a component: an estimate that was under way has no
    /// other end; of a change the component tells. Whether the component was run for an estimate
    /// only, so that nothing has happened to the one that runs.
    pub fn after_loss(&mut self) -> bool {
        let Some((decision, number)) = self.estimating.take() else {
            return false;
        };
        self.observe(Observation::Estimated {
            decision,
            number,
            answer: Answer::Crashed("its thread was lost in the C library".to_owned()),
        });
        true
    }

    /// What the fault manager has given up is no instance any more; what runs is decided upon anew.
    fn take_requests(&mut self) {
        let requests = &self.environment.adaptation_requests;
        let asked = requests.take(|component| self.performer.owns(component));
        if asked.is_empty() {
            return;
        }
        for (component, _) in &asked {
            self.performer.give_up(*component);
        }
        self.asked.extend(asked);
        if let Some(task) = self.performer.changed_task() {
            self.observe(Observation::TaskChanged(Box::new(task)));
        }
        self.answer_requests("it was not in use");
    }

    /// Tells the fault manager of components without which the task is done now, or without which
    /// it cannot be done.
    fn answer_requests(&mut self, how: &str) {
        let decides = self.decider.state() != DeciderState::Monitoring;
        let asked = std::mem::take(&mut self.asked);
        for (component, action) in asked {
            let is_used = self.performer.uses(self.decider.running(), component);
            if is_used && decides {
                self.asked.push((component, action));
                continue;
            }
            let outcome = match is_used {
                false => ActionOutcome::Done {
                    incarnation: 0,
                    note: how.to_owned(),
                },
                true => ActionOutcome::Failed {
                    reason: how.to_owned(),
                },
            };
            let ended = fault_manager::Observation::Ended { action, outcome };
            self.environment.observations.report(ended);
        }
    }

    fn evaluate(&mut self, lane: &Lane) {
        let is_due = self.performer.listen(self.decider.running(), lane);
        if self.decider.state() != DeciderState::Monitoring {
            return;
        }
        if let Some(task) = self.performer.changed_task() {
            self.observe(Observation::TaskChanged(Box::new(task)));
        }
        if is_due && let Some(answer) = self.performer.evaluate(self.decider.running()) {
            self.observe(Observation::Evaluated(answer));
        }
    }

    fn observe(&mut self, observation: Observation) {
        let now = self.environment.clock.now();
        self.effects.extend(self.decider.observe(observation, now));
    }

    fn work_off(&mut self, lane: &Lane) {
        while let Some(effect) = self.effects.pop_front() {
            if let Some(answer) = self.carry_out(effect, lane) {
                self.observe(answer);
            }
        }
    }

    fn carry_out(&mut self, effect: Effect, lane: &Lane) -> Option<Observation> {
        match effect {
            Effect::Synthesise { decision } => {
                let running = Some(self.decider.running());
                let result = generate(self.decider.task(), running);
                Some(Observation::Synthesised { decision, result })
            }
            Effect::Estimate {
                decision,
                number,
                candidate,
            } => {
                self.estimating = Some((decision, number));
                let request = Request {
                    decision,
                    number,
                    candidate: &candidate,
                    running: self.decider.running(),
                };
                let answer = self.performer.estimate(request, lane);
                self.estimating = None;
                answer
            }
            Effect::Reconfigure {
                decision,
                number,
                candidate,
            } => {
                let request = Request {
                    decision,
                    number,
                    candidate: &candidate,
                    running: self.decider.running(),
                };
                self.performer.reconfigure(request, lane)
            }
            Effect::Abandon { .. } => {
                self.performer.abandon(lane);
                None
            }
            Effect::Decided(verdict) => {
                let record = AdaptationRecord::of(self.decider.task(), &verdict);
                let now_ns = self.environment.clock.now_ns();
                let how = record.text.clone();
                let has_changed = matches!(verdict.outcome, Outcome::Changed(_));
                self.environment.adaptation_requests.count(has_changed);
                let event = Event::Adaptation(Box::new(record));
                self.environment.events.record(now_ns, event);
                self.answer_requests(&how);
                None
            }
        }
    }
}
