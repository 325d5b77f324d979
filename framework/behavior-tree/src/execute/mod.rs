//! One tick of a tree, node by node.

mod adaptive;
mod choices;
mod cost;
mod decorators;
mod leaves;
mod navigation;
mod parallel;
mod sequences;
mod updates;

use std::time::Duration;

use crate::blackboard::Blackboard;
use crate::leaf::{Leaf, LeafContext};
use crate::plan::{Conditions, Kind, Node, NodeId, Plan, Source};
use crate::script::{Environment as _, Script};
use crate::status::Status;
use crate::tree::{Observer, TickError};
use crate::value::Value;

/// Where a node has got to. Each kind of node uses of it what it needs.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct State {
    pub(crate) status: Status,
    /// The child whose turn it is.
    index: u32,
    /// Attempts, cycles, failures.
    count: u32,
    /// Children that answered SKIPPED since the node began.
    skipped: u32,
    /// What a parallel parent remembers of this node: how it completed, or IDLE.
    mark: Status,
    /// What the node remembers of itself.
    kept: Status,
    flag: bool,
    /// When the node began, or its timer did.
    since: Duration,
    /// How often the entry that the node watches had been written when it was last looked at.
    writes: u64,
    /// How often a Decider or Reactor has chosen this node since it began.
    chosen: u32,
}

/// A boxed error keeps the answer of every node small.
pub(crate) type Ticked<T = Status> = Result<T, Box<TickError>>;

pub(crate) struct Engine<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) states: &'a mut [State],
    pub(crate) board: &'a mut Blackboard,
    pub(crate) leaves: &'a mut [Box<dyn Leaf>],
    pub(crate) now: Duration,
    pub(crate) observer: &'a mut dyn Observer,
    pub(crate) is_woken: &'a mut bool,
    /// What went wrong while something was being halted, which goes on all the same.
    pub(crate) trouble: Option<Box<TickError>>,
}

impl<'a> Engine<'a> {
    /// Ticks a node: its pre-conditions, its work, its post-conditions.
    pub(crate) fn tick(&mut self, id: NodeId) -> Ticked {
        let status = match &self.node(id).conditions {
            None => self.perform(id),
            Some(conditions) => self.perform_on_conditions(id, conditions),
        };
        match status {
            Ok(Status::Skipped) => {
                self.set_status(id, Status::Idle);
                Ok(Status::Skipped)
            }
            Ok(Status::Idle) => {
                let message = "answered IDLE, which no node may".to_owned();
                Err(self.error(id, message))
            }
            Ok(status) => {
                self.set_status(id, status);
                Ok(status)
            }
            Err(error) => {
                // Children may be running: whoever halts this node must come by them.
                if !self.plan.children(id).is_empty() {
                    self.set_status(id, Status::Running);
                }
                Err(error)
            }
        }
    }

    /// Ends what is running in a node and makes it idle.
    pub(crate) fn halt(&mut self, id: NodeId) {
        if self.state(id).status == Status::Running {
            self.halt_children(id);
            let node = self.node(id);
            if node.kind == Kind::Leaf {
                self.with_leaf(id, |leaf, context| leaf.halt(context));
            }
            self.forget(id, node.kind);
            if let Some(conditions) = &node.conditions
                && let Some(script) = &conditions.on_halted
                && let Err(error) = self.run(id, script)
            {
                self.trouble.get_or_insert(error);
            }
        }
        self.set_status(id, Status::Idle);
    }

    /// Halts all children of a node.
    fn halt_children(&mut self, id: NodeId) {
        let plan = self.plan;
        for &child in plan.children(id) {
            self.halt(child);
        }
    }

    /// Makes a node idle that has completed.
    pub(crate) fn reset(&mut self, id: NodeId) {
        if self.state(id).status.is_completed() {
            self.set_status(id, Status::Idle);
        }
    }

    /// What went wrong while something was being halted.
    pub(crate) fn take_trouble(&mut self) -> Option<Box<TickError>> {
        self.trouble.take()
    }

    fn perform_on_conditions(&mut self, id: NodeId, conditions: &Conditions) -> Ticked {
        let status = match self.decided_before(id, conditions)? {
            Some(status) => status,
            None => self.perform(id)?,
        };
        let script = match status {
            Status::Success => &conditions.on_success,
            Status::Failure => &conditions.on_failure,
            _ => return Ok(status),
        };
        for script in [script, &conditions.post].into_iter().flatten() {
            self.run(id, script)?;
        }
        Ok(status)
    }

    fn decided_before(&mut self, id: NodeId, conditions: &Conditions) -> Ticked<Option<Status>> {
        let is_running = self.state(id).status == Status::Running;
        if !is_running {
            for (script, status) in [
                (&conditions.failure_if, Status::Failure),
                (&conditions.success_if, Status::Success),
                (&conditions.skip_if, Status::Skipped),
            ] {
                if let Some(script) = script
                    && self.holds(id, script)?
                {
                    return Ok(Some(status));
                }
            }
        }
        match &conditions.while_true {
            Some(script) if !self.holds(id, script)? => {
                self.halt(id);
                Ok(Some(Status::Skipped))
            }
            _ => Ok(None),
        }
    }

    fn perform(&mut self, id: NodeId) -> Ticked {
        use Status::{Failure, Success};
        match self.node(id).kind {
            Kind::Sequence => self.in_order(id, Success, false),
            Kind::AsyncSequence => self.in_order(id, Success, true),
            Kind::SequenceWithMemory => self.in_order_with_memory(id),
            Kind::Fallback => self.in_order(id, Failure, false),
            Kind::AsyncFallback => self.in_order(id, Failure, true),
            Kind::ReactiveSequence => self.anew(id, Success),
            Kind::ReactiveFallback => self.anew(id, Failure),
            Kind::IfThenElse => self.if_then_else(id),
            Kind::WhileDoElse => self.while_do_else(id),
            Kind::TryCatch => self.try_catch(id),
            Kind::Switch => self.switch(id),
            Kind::Parallel => self.parallel(id),
            Kind::ParallelAll => self.parallel_all(id),
            Kind::Recovery => self.recovery(id),
            Kind::PipelineSequence => self.pipeline(id),
            Kind::RoundRobin => self.round_robin(id),
            Kind::NonblockingSequence => self.nonblocking(id),
            Kind::PersistentSequence => self.persistent(id),
            Kind::Module => self.module(id),
            Kind::Decider => self.decider(id),
            Kind::Reactor => self.reactor(id),
            Kind::AlwaysSuccess => Ok(Success),
            Kind::AlwaysFailure => Ok(Failure),
            Kind::Script
            | Kind::ScriptCondition
            | Kind::SetBlackboard
            | Kind::UnsetBlackboard
            | Kind::Sleep
            | Kind::Leaf => self.leaf(id),
            Kind::SkipUnlessUpdated | Kind::WaitValueUpdate | Kind::WasEntryUpdated => {
                self.updated(id)
            }
            _ => self.decorator(id),
        }
    }

    /// Forgets what a node that is halted has in work.
    fn forget(&mut self, id: NodeId, kind: Kind) {
        let state = self.state_mut(id);
        // These two are made to go on where they were.
        if !matches!(kind, Kind::SequenceWithMemory | Kind::PersistentSequence) {
            state.index = 0;
        }
        (state.count, state.skipped) = (0, 0);
        if kind == Kind::Module {
            state.flag = false;
        }
    }

    fn node(&self, id: NodeId) -> &'a Node {
        let plan = self.plan;
        &plan.nodes[id.index()]
    }

    fn child(&self, id: NodeId, position: usize) -> NodeId {
        self.plan.children(id)[position]
    }

    fn state(&self, id: NodeId) -> &State {
        &self.states[id.index()]
    }

    fn state_mut(&mut self, id: NodeId) -> &mut State {
        &mut self.states[id.index()]
    }

    /// Whether the node was not at work before this tick.
    fn begins(&self, id: NodeId) -> bool {
        self.state(id).status != Status::Running
    }

    fn set_status(&mut self, id: NodeId, status: Status) {
        let before = std::mem::replace(&mut self.state_mut(id).status, status);
        if before != status {
            self.observer.changed(id, before, status);
        }
    }

    fn with_leaf<T>(
        &mut self,
        id: NodeId,
        act: impl FnOnce(&mut dyn Leaf, &mut LeafContext<'_>) -> T,
    ) -> T {
        let begins = self.begins(id);
        let leaf = &mut self.leaves[self.node(id).leaf as usize];
        let mut context = LeafContext {
            now: self.now,
            begins,
            node: id,
            plan: self.plan,
            board: self.board,
        };
        act(leaf.as_mut(), &mut context)
    }

    fn run(&mut self, id: NodeId, script: &Script) -> Ticked<Value> {
        script
            .evaluate(self.board)
            .map_err(|message| self.error(id, message))
    }

    fn holds(&mut self, id: NodeId, script: &Script) -> Ticked<bool> {
        script
            .holds(self.board)
            .map_err(|message| self.error(id, message))
    }

    /// The value at a port, by its position in the node's declaration.
    fn input(&self, id: NodeId, port: usize) -> Option<&Value> {
        match &self.node(id).ports[port] {
            Source::Nothing => None,
            Source::Literal(value) => Some(value),
            Source::Entry(slot) => self.board.get(*slot),
        }
    }

    fn number(&self, id: NodeId, port: usize) -> Ticked<f64> {
        let number = self.input(id, port).and_then(Value::as_number);
        number.ok_or_else(|| self.bad_port(id, port, "a number"))
    }

    fn boolean(&self, id: NodeId, port: usize) -> Ticked<bool> {
        let boolean = self.input(id, port).and_then(Value::as_boolean);
        boolean.ok_or_else(|| self.bad_port(id, port, "true or false"))
    }

    fn status_at(&self, id: NodeId, port: usize) -> Ticked<Status> {
        let status = match self.input(id, port) {
            Some(Value::Text(text)) => Status::named(text),
            _ => None,
        };
        status.ok_or_else(|| self.bad_port(id, port, "a status"))
    }

    /// A time in milliseconds; what is negative is no time at all.
    fn milliseconds(&self, id: NodeId, port: usize) -> Ticked<Duration> {
        let milliseconds = self.number(id, port)?;
        let seconds = (milliseconds / 1000.0).max(0.0);
        Duration::try_from_secs_f64(seconds).map_err(|_| self.bad_port(id, port, "a time"))
    }

    fn bad_port(&self, id: NodeId, port: usize, expected: &str) -> Box<TickError> {
        let name = &self.plan.describe(id).ports[port].0;
        let found = match (self.input(id, port), &self.node(id).ports[port]) {
            (Some(value), _) => format!("`{value}`"),
            (None, Source::Entry(slot)) => format!("the empty entry `{}`", self.board.name(*slot)),
            (None, _) => "nothing".to_owned(),
        };
        self.error(id, format!("port {name} needs {expected}, and has {found}"))
    }

    fn error(&self, id: NodeId, message: String) -> Box<TickError> {
        Box::new(TickError {
            path: self.plan.describe(id).path.clone(),
            message,
        })
    }
}
