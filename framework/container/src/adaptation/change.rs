//! From one way of doing the task to another on this robot: make before break. New components are
//! started and work on the newest data at once; an input changes over to a new source when that has
//! written a first good datum; the old connections and components are kept until the new way of doing
//! the task has been found good by whoever decides. If that does not happen everything goes back.

use system_model::life_cycle::{LifeCycleState, Operation};
use system_model::specification::ExecutionKind;
use system_model::task::{ComponentIndex, Placement};

use super::local::LocalRobot;
use super::wiring::{Hop, added, affected};
use crate::component::OperationError;
use crate::guard::Callback;
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
    /// All inputs have changed over; what is not needed any more is still there.
    Switched,
    /// It has failed; what ran goes on.
    Failed(String),
}

impl LocalRobot {
    /// Begins a change; [`Self::advance`] goes on with it. Components that ran on another robot go on
    /// from `memories`, which are by component of the task.
    ///
    /// # Errors
    /// Why it cannot be begun; what ran goes on.
    pub fn begin_change(
        &mut self,
        wanted: &[Placement],
        before: &[Placement],
        memories: &[(ComponentIndex, Vec<u8>)],
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
        let made = self.make(wanted, before, memories, lane);
        if made.is_err() {
            self.go_back(lane);
        }
        made
    }

    fn make(
        &mut self,
        wanted: &[Placement],
        before: &[Placement],
        memories: &[(ComponentIndex, Vec<u8>)],
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
        let mut hops = added(&self.hops(wanted), &self.hops(before));
        // What comes back from another robot is to find its way in.
        hops.sort_by_key(|hop| self.binding.input(hop).is_none());
        for hop in hops {
            let Some((input, receiver)) = self.connect(&hop, lane)? else {
                continue;
            };
            if new.contains(&input.component) {
                self.plug_in(&input, Some(receiver), lane)?;
            } else if let Some(change) = &mut self.change {
                change.switches.push(Switch {
                    hop,
                    aside: Some(receiver),
                    is_done: false,
                });
            }
        }
        for component in new {
            let part = self.binding.part_of(component);
            let task_component = part.map(|part| part.placement.component);
            let memory = memories.iter().find(|(of, _)| Some(*of) == task_component);
            self.start(component, memory.map(|(_, memory)| memory.as_slice()), lane)?;
        }
        Ok(())
    }

    /// The registered memory of a component that leaves this system's robots, or goes from one of them to
    /// another; none if it has registered none.
    pub(super) fn memory(&self, placement: Placement, lane: &Lane) -> Option<Vec<u8>> {
        let part = self.binding.part(placement)?;
        self.enter(part.component, lane).ok()?.critical_copy()
    }

    /// Starts a component, and lets it work on what it has been given.
    fn start(&mut self, index: usize, memory: Option<&[u8]>, lane: &Lane) -> Result<(), String> {
        let status = &self.statuses[index];
        let name = status.name.clone();
        if let Some(change) = &mut self.change {
            change.started.push((index, status.faults()));
        }
        status.set_dormant(false);
        let mut component = self.enter(index, lane)?;
        let words = |error| match error {
            OperationError::Refused => format!("'{name}' cannot be started"),
            OperationError::Failed(fault) => {
                format!(
                    "'{name}': {} in {}: {}",
                    fault.kind, fault.callback, fault.message
                )
            }
        };
        if memory.is_some_and(|memory| component.set_critical(memory)) {
            let recovered = component.call_back(Callback::Recover, "onRecover", lane.loss());
            recovered.map_err(words)?;
        }
        component
            .operate(Operation::Start, lane.loss())
            .map_err(words)?;
        if self.executions[index].0 != ExecutionKind::Passive {
            component.execute(self.now_ns(), lane.loss());
        }
        if component.is_active() {
            component.updated(lane.loss());
        }
        Ok(())
    }

    /// Goes on with the change that is under way. Where it fails everything goes back.
    pub fn advance(&mut self, lane: &Lane) -> Progress {
        let Some(change) = &self.change else {
            return Progress::UnderWay;
        };
        if let Some(how) = self.failure(change) {
            self.go_back(lane);
            return Progress::Failed(how);
        }
        if !change.is_switched
            && let Err(how) = self.switch_over(lane)
        {
            self.go_back(lane);
            return Progress::Failed(how);
        }
        match &self.change {
            Some(change) if change.is_switched => Progress::Switched,
            _ => Progress::UnderWay,
        }
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

    /// Whether a source has written something good since the change was begun; of one elsewhere
    /// whether anything has come from it.
    fn is_good_source(&self, change: &Change, hop: &Hop) -> bool {
        let Some((output, _)) = self.binding.output(hop) else {
            let passage = self.passage.as_ref();
            let came_ns = passage.and_then(|it| it.newest_ns(hop));
            return came_ns.is_some_and(|came_ns| came_ns >= change.begun_ns);
        };
        let source = output.component;
        if !change.started.iter().any(|(started, _)| *started == source) {
            return true;
        }
        let newest = self.outlet(output).and_then(|outlet| outlet.newest());
        let part = self.binding.part(hop.from);
        let is_good = part.is_none_or(|part| {
            let threshold = self.binding.task.components[part.placement.component].threshold;
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
        for placement in affected {
            let Some(part) = self.binding.part(placement) else {
                continue;
            };
            let outlets = self.outlets.iter_mut();
            let own = outlets.filter(|it| it.key.component == part.component);
            own.for_each(|outlet| outlet.forget_before(now_ns));
        }
        Ok(())
    }

    /// Gives an input the source that it has not now.
    pub(super) fn exchange(&mut self, index: usize, lane: &Lane) -> Result<(), String> {
        let Some(change) = &mut self.change else {
            return Ok(());
        };
        let aside = change.switches[index].aside.take();
        let hop = change.switches[index].hop;
        let Some((input, _)) = self.binding.input(&hop) else {
            return Ok(());
        };
        let old = self.plug_in(input, aside, lane)?;
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
