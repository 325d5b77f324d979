//! The shell: what is heard becomes observations of the decider, what it asks for is done, each
//! decision goes on record.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use fault_manager::{ActionId, ActionOutcome};
use task_adaptation::{Decider, DeciderState, Effect, Observation, Outcome, generate};

use super::record::AdaptationRecord;
use super::team::{Request, Team};
use crate::clock::nanoseconds;
use crate::component::Environment;
use crate::event_log::Event;
use crate::lane::Lane;
use crate::wake::Wake;

/// How often a change that is under way is looked at: a fraction of any period of a robot's data.
const CHANGE_PERIOD: Duration = Duration::from_millis(1);

/// One task that is watched over.
pub struct Adaptation {
    decider: Decider,
    team: Team,
    environment: Arc<Environment>,
    /// What is to be done; kept here and not on a stack that may be lost.
    effects: VecDeque<Effect>,
    /// When what runs is evaluated next, in nanoseconds.
    evaluates_ns: u64,
    /// What the fault manager waits for: components, and its actions.
    asked: Vec<(usize, ActionId)>,
}

impl Adaptation {
    /// Watches over a task; nothing of it runs yet.
    pub fn new(decider: Decider, team: Team, environment: Arc<Environment>) -> Self {
        Self {
            decider,
            team,
            environment,
            effects: VecDeque::new(),
            evaluates_ns: 0,
            asked: Vec::new(),
        }
    }

    /// What becomes awake when other robots have told something.
    pub fn wake(&self) -> Option<Arc<Wake>> {
        self.team.wake()
    }

    /// When it wants to look next, in nanoseconds of the container's clock.
    pub fn due_ns(&self) -> u64 {
        let requests = &self.environment.adaptation_requests;
        if !self.effects.is_empty() || requests.any(|component| self.team.owns(component)) {
            return 0;
        }
        let decider = self.decider.deadline().map_or(u64::MAX, nanoseconds);
        let due_ns = self.evaluates_ns.min(decider);
        match self.team.is_changing() {
            true => due_ns.min(self.environment.clock.now_ns() + nanoseconds(CHANGE_PERIOD)),
            false => due_ns,
        }
    }

    /// Looks, and does what is due. Runs code of components.
    pub fn look(&mut self, lane: &Lane) {
        self.attend(lane);
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
            .is_some_and(|deadline| deadline <= now && self.team.decides())
        {
            self.observe(Observation::TimePassed);
            self.work_off(lane);
        }
        while let Some(answer) = self.team.go_on(lane) {
            self.observe(answer);
            self.work_off(lane);
        }
    }

    /// Takes what other robots have told.
    fn attend(&mut self, lane: &Lane) {
        let news = self.team.attend(self.decider.running(), lane);
        if let Some(running) = news.running {
            let now = self.environment.clock.now();
            self.effects.extend(self.decider.follow(running, now));
        }
        if let Some(how) = news.decided {
            self.answer_requests(&how);
        }
        for answer in news.answers {
            self.observe(answer);
        }
    }

    /// The lane's thread was lost in code of a component: an estimate that was under way has no
    /// other end; of a change the component tells. Whether the component was run for an estimate
    /// only, so that nothing has happened to the one that runs.
    pub fn after_loss(&mut self) -> bool {
        let Some(answer) = self.team.after_loss() else {
            return false;
        };
        if let Some(answer) = answer {
            self.observe(answer);
        }
        true
    }

    /// What the fault manager has given up is no instance any more; what runs is decided upon anew.
    fn take_requests(&mut self) {
        let requests = &self.environment.adaptation_requests;
        let asked = requests.take(|component| self.team.owns(component));
        if asked.is_empty() {
            return;
        }
        for (component, _) in &asked {
            self.team.give_up(*component);
        }
        self.asked.extend(asked);
        if self.team.decides() {
            self.look_at_robots();
            self.answer_requests("it was not in use");
        }
    }

    /// Tells the fault manager of components without which the task is done now, or without which
    /// it cannot be done.
    fn answer_requests(&mut self, how: &str) {
        let decides = self.decider.state() != DeciderState::Monitoring;
        let asked = std::mem::take(&mut self.asked);
        for (component, action) in asked {
            let is_used = self.team.uses(self.decider.running(), component);
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
        let is_due = self.team.listen(self.decider.running(), lane);
        if self.decider.state() != DeciderState::Monitoring || !self.team.decides() {
            return;
        }
        self.look_at_robots();
        if is_due && let Some(answer) = self.team.evaluate(self.decider.running()) {
            self.observe(Observation::Evaluated(answer));
        }
    }

    fn look_at_robots(&mut self) {
        if let Some(task) = self.team.changed_task() {
            self.observe(Observation::TaskChanged(Box::new(task)));
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
                let request = Request {
                    decision,
                    number,
                    candidate: &candidate,
                    running: self.decider.running(),
                };
                self.team.estimate(request, lane)
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
                self.team.reconfigure(request, lane);
                None
            }
            Effect::Abandon { .. } => {
                self.team.abandon(lane);
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
                self.team.tell_what_runs(self.decider.running(), Some(how));
                None
            }
        }
    }
}
