//! One tree at work: when it is ticked, what it is ordered, and what becomes of a tick that fails.

mod ticking;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};

use behavior_tree::{NodeId, Status, Tree};
use fault_manager::{ActionId, ActionOutcome, Observation};
use system_model::mission::{DeclaredTree, TreeStart};

use super::reach::Reach;
use super::record::Record;
use super::status::{Phase, TreeStatus};
use crate::clock::nanoseconds;
use crate::component::Environment;
use crate::event_log::Event;
use crate::supervision::{Order, Orders, Task};
use ticking::{Mishap, overrun, words};

/// What a tree is made of.
pub struct Setting {
    /// As the application declares it.
    pub declared: DeclaredTree,
    /// The tree, with leaves that act.
    pub tree: Tree,
    /// The way to components.
    pub reach: Arc<Reach>,
    /// What the fault manager asks of it.
    pub orders: Arc<Orders>,
    /// What others know of it.
    pub status: Arc<TreeStatus>,
}

/// A tree at work.
pub struct Runner {
    declared: DeclaredTree,
    tree: Tree,
    reach: Arc<Reach>,
    orders: Arc<Orders>,
    status: Arc<TreeStatus>,
    environment: Arc<Environment>,
    record: Record,
    phase: Phase,
    due_ns: u64,
    /// How often it has begun.
    incarnation: u32,
    /// The action that it was begun for, by a fault rule, and when it must have ended.
    handles: Option<(ActionId, u64)>,
}

impl Runner {
    /// A tree that has not begun.
    pub fn new(setting: Setting) -> Self {
        let environment = Arc::clone(setting.reach.supervisor().environment());
        Self {
            record: Record::new(setting.tree.plan()),
            declared: setting.declared,
            tree: setting.tree,
            reach: setting.reach,
            orders: setting.orders,
            status: setting.status,
            environment,
            phase: Phase::Waiting,
            due_ns: 0,
            incarnation: 1,
            handles: None,
        }
    }

    /// All components have been started.
    pub fn begin(&mut self) {
        if self.declared.starts == TreeStart::WithApplication {
            self.start(None);
        }
    }

    /// When it wants to be ticked next, in nanoseconds of the container's clock.
    pub fn due_ns(&self) -> Option<u64> {
        (self.phase == Phase::Running).then_some(self.due_ns)
    }

    /// Whether orders wait.
    pub fn has_orders(&self) -> bool {
        !self.orders.is_empty()
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.declared.name
    }

    /// What others know of it.
    pub fn status(&self) -> Arc<TreeStatus> {
        Arc::clone(&self.status)
    }

    /// Does what the fault manager asks.
    pub fn obey(&mut self) {
        while let Some(order) = self.orders.take() {
            self.carry_out(&order);
        }
    }

    /// Ticks the tree if that is due.
    pub fn tick(&mut self) {
        let now_ns = self.environment.clock.now_ns();
        if self.due_ns().is_none_or(|due_ns| due_ns > now_ns) {
            return;
        }
        if self.handles.is_some_and(|(_, until_ns)| until_ns <= now_ns) {
            self.halt();
            self.end(Phase::Failure);
            return self.put_on_record();
        }
        let period_ns = nanoseconds(self.declared.tick);
        // A tick that comes late does not make the next ones hurry.
        self.due_ns = (self.due_ns + period_ns).max(now_ns + 1);
        let began = Instant::now();
        let ticked = self.rounds(Duration::from_nanos(now_ns), began);
        let simulated = self.environment.clock.is_simulated();
        let took = if simulated {
            Duration::ZERO
        } else {
            began.elapsed()
        };
        self.status.count_tick(nanoseconds(took));
        match ticked {
            Ok(_) if took > self.declared.tick_deadline => {
                self.fail(&overrun(took, &self.declared))
            }
            Ok(Status::Running) => {}
            Ok(Status::Success) => self.end(Phase::Success),
            Ok(_) => self.end(Phase::Failure),
            Err(mishap) => self.fail(&mishap),
        }
        self.reach.expire(Duration::from_nanos(now_ns));
        self.put_on_record();
    }

    /// Ends what is running, as when the application stops.
    pub fn stop(&mut self) {
        if self.phase == Phase::Running {
            self.halt();
            self.set_phase(Phase::Stopped);
            self.put_on_record();
        }
    }

    fn carry_out(&mut self, order: &Order) {
        let before = self.phase;
        match &order.task {
            Task::Handle { .. } if before == Phase::Running => {
                let busy = Err("it is handling another fault".to_owned());
                return self.report_end(order.action, busy);
            }
            Task::Handle { until_ns } => {
                self.incarnation += 1;
                // Its end is that of the order.
                return self.start(order.action.map(|action| (action, *until_ns)));
            }
            Task::Reset { .. } => {
                self.halt();
                self.incarnation += 1;
                self.start(None);
            }
            Task::Stop | Task::Destroy => {
                self.halt();
                self.answer_handling(Err("it was stopped".to_owned()));
                self.set_phase(Phase::Stopped);
            }
            // Trees have no secondaries, are no actuators and have no ports.
            _ => {}
        }
        self.put_on_record();
        let note = format!("it was {}", before.name());
        self.report_end(order.action, Ok(note));
    }

    fn start(&mut self, handles: Option<(ActionId, u64)>) {
        self.handles = handles;
        self.due_ns = self.environment.clock.now_ns();
        self.set_phase(Phase::Running);
    }

    fn end(&mut self, phase: Phase) {
        self.set_phase(phase);
        let result = match phase {
            Phase::Success => Ok("its root answered SUCCESS".to_owned()),
            _ => Err("its root answered FAILURE".to_owned()),
        };
        self.answer_handling(result);
    }

    /// The tree could not do its work: whatever runs in it is ended, and the rest is the fault
    /// manager's business.
    fn fail(&mut self, mishap: &Mishap) {
        self.halt();
        self.set_phase(Phase::Failed);
        self.answer_handling(Err(mishap.message.clone()));
        self.reach
            .fail(mishap.kind, mishap.message.clone(), self.incarnation);
    }

    /// Ends what is running. A leaf that panics even then is not asked again.
    fn halt(&mut self) {
        let now = self.environment.clock.now();
        let tree = &mut self.tree;
        let mut nobody = |_: NodeId, _: Status, _: Status| {};
        let halted = catch_unwind(AssertUnwindSafe(|| tree.halt(now, &mut nobody)));
        match halted {
            Err(panic) => {
                self.tree.abandon();
                let message = format!("while it was halted: {}", words(panic.as_ref()));
                self.reach.notice(&message);
            }
            Ok(Err(error)) => self.reach.notice(&format!("while it was halted: {error}")),
            Ok(Ok(())) => {}
        }
        self.reach.expire(Duration::MAX);
    }

    /// Tells the fault rule that the tree was begun for how it has ended.
    fn answer_handling(&mut self, result: Result<String, String>) {
        if let Some((action, _)) = self.handles.take() {
            self.report_end(Some(action), result);
        }
    }

    fn report_end(&self, action: Option<ActionId>, result: Result<String, String>) {
        let Some(action) = action else { return };
        let outcome = match result {
            Ok(note) => ActionOutcome::Done {
                incarnation: self.incarnation,
                note,
            },
            Err(reason) => ActionOutcome::Failed { reason },
        };
        self.reach
            .supervisor()
            .observe(Observation::Ended { action, outcome });
    }

    fn set_phase(&mut self, phase: Phase) {
        let before = std::mem::replace(&mut self.phase, phase);
        self.status.set_phase(phase);
        if before != phase {
            self.tell(Event::TreeState {
                tree: self.declared.name.clone(),
                from: before.name(),
                to: phase.name(),
            });
        }
    }

    fn put_on_record(&mut self) {
        let (tree, now) = (&self.tree, self.environment.clock.now());
        let changes = self
            .record
            .changes(now, tree.plan(), |node| tree.status(node));
        let Some(changes) = changes else { return };
        self.status.set_nodes(|node| tree.status(node));
        self.tell(Event::TreeNodes {
            tree: self.declared.name.clone(),
            nodes: changes.nodes,
            left_out: changes.left_out,
        });
    }

    fn tell(&self, event: Event) {
        let now_ns = self.environment.clock.now_ns();
        self.environment.events.record(now_ns, event);
    }
}
