//! Executors and cycles.

use std::time::Duration;

use super::misfortune::Strike;
use super::orders::Order;
use super::{APERIODIC_CYCLE, Component, StandIn, State};
use crate::evidence::Evidence;
use crate::manager::FaultManager;
use crate::observation::{DetectorKind, Observation, Symptom};
use crate::what_if::ERROR_CODE;
use std::collections::VecDeque;
use system_model::fault::FaultKind;
use system_model::specification::ExecutionKind;

/// What runs components.
#[derive(Debug)]
pub(super) struct Executor {
    kind: ExecutionKind,
    period: Duration,
    pub members: Vec<usize>,
    /// When it is due next; for one without a period, the earliest time it may run again.
    due: Duration,
    /// A datum has come for one without a period.
    awake: bool,
    /// By how much its steps were held up.
    pub busy: Duration,
    pub orders: VecDeque<Order>,
}

/// The executors of all applications, in the order in which they run when they are due together.
pub(super) fn executors(manager: &FaultManager, components: &[Component]) -> Vec<Executor> {
    let mut all: Vec<Executor> = (manager.system.executors.iter())
        .map(|members| {
            let execution = &components[members[0]].execution;
            Executor {
                kind: execution.kind,
                period: execution.period,
                members: members.clone(),
                due: Duration::ZERO,
                awake: false,
                busy: Duration::ZERO,
                orders: VecDeque::new(),
            }
        })
        .collect();
    all.sort_by_key(|executor| {
        let leader = &components[executor.members[0]];
        (
            std::cmp::Reverse(leader.execution.priority),
            leader.name.clone(),
        )
    });
    all
}

impl StandIn<'_> {
    /// The next executor by time.
    pub(super) fn next_executor(&self) -> Option<(Duration, usize)> {
        let due = |executor: &Executor| match executor.kind {
            ExecutionKind::Passive => None,
            ExecutionKind::Aperiodic => executor.awake.then_some(executor.due),
            ExecutionKind::Periodic | ExecutionKind::PeriodicShared => Some(executor.due),
        };
        let all = self.executors.iter().enumerate();
        all.filter_map(|(index, executor)| Some((due(executor)?.max(self.now), index)))
            .min()
    }

    /// One cycle: every member works.
    pub(super) fn run_executor(&mut self, index: usize) {
        self.executors[index].awake = false;
        for member in self.executors[index].members.clone() {
            self.execute(member);
            self.serve();
        }
        self.finish_cycle(index);
    }

    /// A cycle that took longer than its period is an overrun, and the next one is due at once.
    fn finish_cycle(&mut self, index: usize) {
        let executor = &mut self.executors[index];
        let end = self.now.saturating_add(std::mem::take(&mut executor.busy));
        if executor.period.is_zero() {
            executor.due = end.saturating_add(APERIODIC_CYCLE);
            return;
        }
        let next = executor.due.saturating_add(executor.period);
        executor.due = next.max(end);
        if end > next {
            for member in &executor.members {
                let component = &mut self.components[*member];
                if component.state == State::Active {
                    component.overruns += 1;
                }
            }
        }
    }

    /// A datum or an event has come for a component.
    pub(super) fn wake(&mut self, component: usize) {
        let executors = self.executors.iter_mut();
        for executor in executors.filter(|one| one.kind == ExecutionKind::Aperiodic) {
            executor.awake |= executor.members.contains(&component);
        }
    }

    /// What kept an executor busy is over: it goes on with its period.
    pub(super) fn goes_on(&mut self, index: usize) {
        let executor = &mut self.executors[index];
        let end = self.now.saturating_add(std::mem::take(&mut executor.busy));
        executor.due = executor.due.min(end.saturating_add(executor.period));
    }

    /// One `onExecute` of a component, if it is active.
    pub(super) fn execute(&mut self, index: usize) {
        if self.components[index].state != State::Active {
            return;
        }
        let component = &self.components[index];
        let limit = component.hang_after;
        match self.misfortune.strike(index, self.now, limit) {
            Some(Strike::Exception(kind)) => return self.fail(index, kind),
            Some(Strike::Hang) => return self.hang(index, limit),
            Some(Strike::Slow(time)) => self.keep_busy(index, time),
            None => {}
        }
        self.read(index);
        self.write(index);
        let component = &mut self.components[index];
        component.cycles += 1;
        if std::mem::take(&mut component.unproven) {
            self.prove(index);
        }
    }

    /// The component works.
    pub(super) fn prove(&mut self, index: usize) {
        let component = &mut self.components[index];
        component.unproven = false;
        let incarnation = component.incarnation;
        self.observe(Observation::Works {
            component: index,
            incarnation,
        });
    }

    fn fail(&mut self, index: usize, kind: FaultKind) {
        self.components[index].state = State::Error;
        let symptom = self.exception(index, DetectorKind::Exception, kind);
        self.observations.extend(symptom);
    }

    /// It is broken off when its time is over, and keeps its executor busy until then.
    fn hang(&mut self, index: usize, limit: Duration) {
        self.keep_busy(index, limit);
        let until = self.now.saturating_add(limit);
        let component = &mut self.components[index];
        component.state = State::Error;
        component.hanging_until = until;
        let symptom = self.exception(index, DetectorKind::Hang, FaultKind::Hang);
        self.matures.extend(symptom.map(|symptom| (until, symptom)));
    }

    fn keep_busy(&mut self, component: usize, time: Duration) {
        let mut executors = self.executors.iter_mut();
        if let Some(executor) = executors.find(|one| one.members.contains(&component)) {
            executor.busy = executor.busy.saturating_add(time);
        }
    }

    fn exception(
        &self,
        index: usize,
        detector: DetectorKind,
        kind: FaultKind,
    ) -> Option<Observation> {
        let component = &self.components[index];
        Some(Observation::Symptom(Box::new(Symptom {
            detector: self.manager.detector(index, &detector)?,
            incarnation: component.incarnation,
            kind,
            return_code: match kind {
                FaultKind::ErrorReturn => ERROR_CODE,
                _ => 0,
            },
            at: self.now,
            runs: false,
            evidence: Evidence::Exception {
                callback: "onExecute".to_owned(),
                message: "supposed".to_owned(),
                place: None,
                signal: None,
                address: None,
                backtrace: Vec::new(),
                thread_lost: false,
                damage: None,
            },
        })))
    }
}
