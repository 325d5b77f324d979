//! From one way of doing the task to another on this robot: make before break. New components are
//! started and work on the newest data at once; an input changes over to a new source when that has
//! written a first good datum; the old connections and components are kept until the new way of doing
//! the task has been found good. If that does not happen everything goes back.

use system_model::life_cycle::{LifeCycleState, Operation};
use system_model::specification::ExecutionKind;
use system_model::task::Placement;
use task_adaptation::judge;

use super::local::LocalRobot;
use super::wiring::{Hop, added, affected};
use crate::component::OperationError;
use crate::lane::Lane;
use crate::port::Receiver;

/// A change that is under way.
pub struct Change {
    /// What shall run.
    pub(super) wanted: Vec<Placement>,
    /// What ran.
    pub(super) before: Vec<Placement>,
    /// When it was begun, in nanoseconds of the container's clock.
    begun_ns: u64,
    /// Components that were started for it, with the faults that each had had.
    pub(super) started: Vec<(usize, u64)>,
    /// Inputs of running components that get another source.
    pub(super) switches: Vec<Switch>,
    /// Whether all of them have changed over.
    is_switched: bool,
}

/// An input that gets another source.
pub(super) struct Switch {
    pub(super) hop: Hop,
    /// Until the input changes over the new connection, after that the old one.
    pub(super) aside: Option<Receiver>,
    pub(super) is_done: bool,
}

/// What came of looking at a change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Progress {
    /// It goes on, or there is none.
    UnderWay,
    /// It is done.
    Done,
    /// It has failed; what ran goes on.
    Failed(String),
}

impl LocalRobot {
    /// Begins a change; [`Self::go_on`] does the rest.
    ///
    /// # Errors
    /// Why it cannot be begun; what ran goes on.
    pub fn begin_change(
        &mut self,
        wanted: &[Placement],
        before: &[Placement],
        lane: &Lane,
    ) -> Result<(), String> {
        self.change = Some(Change {
            wanted: wanted.to_vec(),
            before: before.to_vec(),
            begun_ns: self.now_ns(),
            started: Vec::new(),
            switches: Vec::new(),
            is_switched: false,
        });
        let made = self.make(wanted, before, lane);
        if made.is_err() {
            self.go_back(lane);
        }
        made
    }

    fn make(
        &mut self,
        wanted: &[Placement],
        before: &[Placement],
        lane: &Lane,
    ) -> Result<(), String> {
        let ran = self.members(before);
        let mut new = self.members(wanted);
        new.retain(|component| !ran.contains(component));
        for component in &new {
            let state = self.statuses[*component].state();
            if !matches!(state, LifeCycleState::Ready | LifeCycleState::Inactive) {
                return Err(format!("'{}' is {state}", self.statuses[*component].name));
            }
        }
        for hop in added(&self.hops(wanted), &self.hops(before)) {
            let receiver = self.connect(&hop, lane)?;
            if new.contains(&hop.to.component) {
                self.plug_in(&hop.to, Some(receiver), lane)?;
            } else if let Some(change) = &mut self.change {
                change.switches.push(Switch {
                    hop,
                    aside: Some(receiver),
                    is_done: false,
                });
            }
        }
        for component in new {
            self.start(component, lane)?;
        }
        Ok(())
    }

    /// Starts a component, and lets it work on what it has been given.
    fn start(&mut self, index: usize, lane: &Lane) -> Result<(), String> {
        let status = &self.statuses[index];
        let name = status.name.clone();
        if let Some(change) = &mut self.change {
            change.started.push((index, status.faults()));
        }
        status.set_dormant(false);
        let mut component = self.enter(index, lane)?;
        let started = component.operate(Operation::Start, lane.loss());
        started.map_err(|error| match error {
            OperationError::Refused => format!("'{name}' cannot be started"),
            OperationError::Failed(fault) => {
                format!(
                    "'{name}': {} in {}: {}",
                    fault.kind, fault.callback, fault.message
                )
            }
        })?;
        if self.executions[index].0 != ExecutionKind::Passive {
            component.execute(self.now_ns(), lane.loss());
        }
        if component.is_active() {
            component.updated(lane.loss());
        }
        Ok(())
    }

    /// Goes on with the change that is under way.
    pub fn go_on(&mut self, lane: &Lane) -> Progress {
        let Some(change) = &self.change else {
            return Progress::UnderWay;
        };
        if let Some(how) = self.failure(change) {
            self.go_back(lane);
            return Progress::Failed(how);
        }
        if !change.is_switched {
            if let Err(how) = self.switch_over(lane) {
                self.go_back(lane);
                return Progress::Failed(how);
            }
            return Progress::UnderWay;
        }
        let wanted = change.wanted.clone();
        let is_good = self.performances(&wanted).is_some_and(|answer| {
            let (quality, rejections) = judge(&self.binding.task, &wanted, &answer);
            quality.is_some() && rejections.is_empty()
        });
        if !is_good {
            return Progress::UnderWay;
        }
        self.finish(lane);
        Progress::Done
    }

    /// A component that was started for it, and does not run as it did then.
    fn failure(&self, change: &Change) -> Option<String> {
        let failed = |(index, faults): &&(usize, u64)| {
            let status = &self.statuses[*index];
            status.state() != LifeCycleState::Active || status.faults() > *faults
        };
        let (index, _) = change.started.iter().find(failed)?;
        let status = &self.statuses[*index];
        let fault = status.last_fault();
        let state = status.state();
        Some(format!(
            "'{}' {}",
            status.name,
            fault.map_or_else(|| format!("is {state}"), |fault| format!("failed: {fault}"))
        ))
    }

    /// Whether a source has written something good since the change was begun.
    fn is_good_source(&self, change: &Change, hop: &Hop) -> bool {
        let source = hop.from.component;
        if !change.started.iter().any(|(started, _)| *started == source) {
            return true;
        }
        let newest = self.outlet(&hop.from).and_then(|outlet| outlet.newest());
        let component = self.binding.task_component(source);
        let part = component.and_then(|index| Some((index, self.binding.parts[index].as_ref()?)));
        let is_good = part.is_none_or(|(index, part)| {
            let threshold = self.binding.task.components[index].threshold;
            part.evaluators.is_empty() || self.error(part).is_some_and(|error| error <= threshold)
        });
        is_good && newest.is_some_and(|it| it.stamp_ns >= change.begun_ns)
    }

    /// Changes all inputs over whose new source is good.
    fn switch_over(&mut self, lane: &Lane) -> Result<(), String> {
        let count = self.change.as_ref().map_or(0, |it| it.switches.len());
        for index in 0..count {
            let Some(change) = &self.change else { break };
            let switch = &change.switches[index];
            if !switch.is_done && self.is_good_source(change, &switch.hop) {
                self.exchange(index, lane)?;
            }
        }
        let now_ns = self.now_ns();
        let Some(change) = &mut self.change else {
            return Ok(());
        };
        if !change.switches.iter().all(|it| it.is_done) {
            return Ok(());
        }
        change.is_switched = true;
        let (wanted, before) = (change.wanted.clone(), change.before.clone());
        // What was written before tells nothing of the new way of doing the task.
        let affected = affected(&self.hops(&wanted), &self.hops(&before));
        for outlet in &mut self.outlets {
            if affected.contains(&outlet.key.component) {
                outlet.forget_before(now_ns);
            }
        }
        Ok(())
    }

    /// Gives an input the source that it has not now.
    pub(super) fn exchange(&mut self, index: usize, lane: &Lane) -> Result<(), String> {
        let Some(change) = &mut self.change else {
            return Ok(());
        };
        let aside = change.switches[index].aside.take();
        let hop = change.switches[index].hop.clone();
        let old = self.plug_in(&hop.to, aside, lane)?;
        if let Some(change) = &mut self.change {
            let switch = &mut change.switches[index];
            (switch.aside, switch.is_done) = (old, !switch.is_done);
        }
        Ok(())
    }

    /// Whether a component was started for the change that is under way.
    pub(super) fn is_started(&self, component: usize) -> bool {
        let change = self.change.as_ref();
        change.is_some_and(|it| it.started.iter().any(|(started, _)| *started == component))
    }
}
