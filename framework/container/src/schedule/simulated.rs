//! All executors on one thread, in simulated time.

mod adapting;
mod idling;
mod playing;
mod trees;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use system_model::specification::ExecutionKind;

use crate::adaptation::Adaptation;
use crate::clock::nanoseconds;
use crate::component::{ComponentCell, Environment, mark_lost};
use crate::event_log::Event;
use crate::executor::Executor;
use crate::guard::loss::LostThread;
use crate::lane::{Lane, Work};
use crate::mission::{Calls, Runner};
use crate::replay::Score;
use crate::supervision::Supervisor;
use playing::{Played, is_played};

/// In simulated time a cycle of an executor without a period takes this long; without it two
/// components that wake each other would stop the clock.
const SIMULATED_CYCLE_NS: u64 = 1_000;

/// How long a component keeps its executor busy in simulated time, where callbacks themselves take
/// none: an injected delay, or a hang until it was broken off.
#[derive(Debug, Default)]
pub struct BusyTime(AtomicU64);

impl BusyTime {
    /// The step that is under way takes so much longer.
    pub fn add(&self, time: Duration) {
        self.0.fetch_add(nanoseconds(time), Ordering::Relaxed);
    }

    /// How much longer the steps since the last time took, in nanoseconds.
    fn take_ns(&self) -> u64 {
        self.0.swap(0, Ordering::Relaxed)
    }
}

/// All executors on one thread, in simulated time: ordered by time, priority, name.
pub struct Simulated {
    executors: Vec<Executor>,
    adaptations: Vec<Adaptation>,
    /// The adaptation that is looking.
    adapting: Option<usize>,
    components: Arc<[Arc<ComponentCell>]>,
    /// When each is due next; for one without a period, the earliest time it may run again.
    due_ns: Vec<u64>,
    /// The one that was running when a thread was lost.
    running: Option<usize>,
    /// The one that was carrying out an order then.
    obeying: Option<usize>,
    environment: Arc<Environment>,
    supervisor: Arc<Supervisor>,
    end_ns: u64,
    /// Behaviour trees, and whether they have been told that all has been started.
    trees: Vec<Runner>,
    trees_begun: bool,
    /// What they ask of services.
    calls: Arc<Calls>,
    /// The recording that is played, and for each executor whether all its components are.
    played: Option<(Arc<Score>, Vec<bool>)>,
}

impl Simulated {
    /// Not begun. Ends at `end` of simulated time, or when every robot has reached its target.
    pub fn new(
        mut executors: Vec<Executor>,
        adaptations: Vec<Adaptation>,
        components: Arc<[Arc<ComponentCell>]>,
        supervisor: Arc<Supervisor>,
        end: Option<Duration>,
    ) -> Self {
        executors.sort_by(|a, b| (b.priority, &a.name).cmp(&(a.priority, &b.name)));
        let environment = Arc::clone(supervisor.environment());
        let begin_ns = environment.clock.now_ns();
        let first = |one: &Executor| {
            // Every run looks at the same moments: on the grid of the period.
            begin_ns.next_multiple_of(nanoseconds(one.period).max(1))
        };
        Self {
            due_ns: executors.iter().map(first).collect(),
            played: environment.score.as_ref().map(|score| {
                let played = executors.iter().map(|one| is_played(one, score));
                (Arc::clone(score), played.collect())
            }),
            executors,
            adaptations,
            adapting: None,
            components,
            running: None,
            obeying: None,
            trees: Vec::new(),
            trees_begun: false,
            calls: Arc::default(),
            environment,
            supervisor,
            end_ns: end.map_or(u64::MAX, nanoseconds),
        }
    }

    /// When an executor wants to run next.
    fn due(&self, index: usize) -> Option<u64> {
        let executor = &self.executors[index];
        if let Some(score) = self.score_of(index) {
            let mut members = executor.members.iter();
            return members
                .any(|member| score.has_cycle(member.number as usize))
                .then_some(0);
        }
        let wanted = executor.kind.has_period() || executor.wake.is_pending();
        wanted.then(|| self.due_ns[index])
    }

    /// The next executor by time; the order of `executors` decides among equals.
    fn next(&self) -> Option<(u64, usize)> {
        let now_ns = self.environment.clock.now_ns();
        (0..self.executors.len())
            .filter_map(|index| Some((self.due(index)?.max(now_ns), index)))
            .min()
    }

    fn run_executor(&mut self, index: usize, lane: &Lane) {
        self.running = Some(index);
        let now_ns = self.environment.clock.now_ns();
        let executor = &mut self.executors[index];
        if !executor.is_in_cycle() {
            executor.wake.take();
        }
        while self.executors[index].step(now_ns, lane) {
            self.serve(lane);
        }
        self.running = None;
        self.finish_cycle(index, now_ns, lane);
    }

    /// Sets the next release, by the same rule as in real time: a cycle that took longer than its
    /// period is reported, and the next one is due at once.
    fn finish_cycle(&mut self, index: usize, now_ns: u64, lane: &Lane) {
        let executor = &self.executors[index];
        let end_ns = now_ns + self.environment.busy.take_ns();
        if let Some(score) = self.score_of(index) {
            for member in &executor.members {
                score.end_cycle(member.number as usize);
            }
            return;
        }
        if !executor.kind.has_period() {
            self.due_ns[index] = end_ns + SIMULATED_CYCLE_NS;
            return;
        }
        executor.status.add_busy_ns(end_ns - now_ns);
        let next_ns = self.due_ns[index] + nanoseconds(executor.period);
        self.due_ns[index] = next_ns.max(end_ns);
        if end_ns > next_ns {
            executor.overran(lane);
            let overrun = Event::Overrun {
                executor: executor.name.clone(),
                cycle: executor.cycles,
                late_ns: end_ns - next_ns,
            };
            self.environment.events.record(now_ns, overrun);
        }
    }

    /// Lets the fault manager see what happened, and does at once what it asks.
    fn serve(&mut self, lane: &Lane) {
        self.supervisor.attend();
        self.serve_executors(lane);
        while self.obey_in_trees() || self.call_for_trees(lane) {
            self.serve_executors(lane);
        }
    }

    fn serve_executors(&mut self, lane: &Lane) {
        while let Some(index) = (self.executors.iter()).position(|one| !one.orders.is_empty()) {
            self.obeying = Some(index);
            self.executors[index].obey(&self.supervisor, lane);
            self.obeying = None;
            // What kept it busy is over: it goes on with its period.
            let executor = &self.executors[index];
            let now_ns = self.environment.clock.now_ns();
            let end_ns = now_ns + self.environment.busy.take_ns();
            let next_ns = end_ns + nanoseconds(executor.period);
            self.due_ns[index] = self.due_ns[index].min(next_ns);
        }
    }

    /// Moves time to `time_ns`; false if the run ends before.
    fn advance(&self, time_ns: u64) -> bool {
        let time_ns = time_ns.min(self.end_ns);
        let environment = &self.environment;
        if (environment.worlds).advance_to(Duration::from_nanos(time_ns), environment) {
            return false;
        }
        environment.clock.advance_to(time_ns);
        time_ns < self.end_ns
    }
}

impl Work for Simulated {
    fn run(&mut self, lane: &Lane) {
        loop {
            if let Some(index) = self.running {
                self.run_executor(index, lane);
                continue;
            }
            if lane.is_stopping() {
                return;
            }
            self.begin_trees();
            self.serve(lane);
            let next = self.next();
            match self.adapt_if_due(next.map(|(time_ns, _)| time_ns), lane) {
                Some(true) => continue,
                Some(false) => return,
                None => {}
            }
            // What time brings comes before what is executed at that time.
            let tick_ns = self.supervisor.due_ns();
            if let Some(tick_ns) = tick_ns
                && self.tree_due_ns().is_none_or(|due_ns| tick_ns <= due_ns)
                && next.is_none_or(|(time_ns, _)| tick_ns <= time_ns)
                && self.cue_ns().is_none_or(|cue_ns| tick_ns <= cue_ns)
                && !self.is_over(next.map(|(time_ns, _)| time_ns))
            {
                if tick_ns > self.environment.clock.now_ns() && !self.advance(tick_ns) {
                    return;
                }
                self.supervisor.tick();
                continue;
            }
            if let Some(due_ns) = self.tree_due_ns()
                && next.is_none_or(|(time_ns, _)| due_ns <= time_ns)
            {
                if due_ns > self.environment.clock.now_ns() && !self.advance(due_ns) {
                    return;
                }
                self.tick_trees();
                continue;
            }
            match self.play(next.map(|(time_ns, _)| time_ns), lane) {
                Played::Nothing => {}
                Played::Some => continue,
                Played::All => return,
            }
            let Some((time_ns, index)) = next else {
                // Nothing will ever happen by itself: only the world moves until the end.
                self.idle_until_end(lane);
                return;
            };
            if time_ns > self.environment.clock.now_ns() && !self.advance(time_ns) {
                return;
            }
            self.run_executor(index, lane);
        }
    }

    fn after_loss(&mut self, lost: &LostThread) {
        if self.lost_in_adaptation(lost) {
            return;
        }
        let index = self.obeying.take().or(self.running);
        match index.and_then(|index| self.executors.get_mut(index)) {
            Some(executor) => executor.after_loss(&self.components, lost, &self.supervisor),
            None => mark_lost(&self.components, lost, false),
        }
    }
}

/// Kinds of executor that run by the clock.
trait HasPeriod {
    fn has_period(self) -> bool;
}

impl HasPeriod for ExecutionKind {
    fn has_period(self) -> bool {
        matches!(self, Self::Periodic | Self::PeriodicShared)
    }
}
