//! Executors: which components run together, in what order, and when.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use fault_manager::ActionId;
use system_model::specification::{ExecutionKind, SchedulingPolicy};

use crate::component::{ComponentCell, mark_lost};
use crate::guard::CallLimit;
use crate::guard::loss::LostThread;
use crate::lane::Lane;
use crate::status::ExecutorStatus;
use crate::supervision::obedience;
use crate::supervision::{Orders, Supervisor};
use crate::wake::Wake;

/// How long an executor waits for a component that another thread is inside of (a service call):
/// then it leaves it out of this cycle. Longer than a short service, shorter than usual periods.
const ENTER_LIMIT: Duration = Duration::from_millis(5);

/// A component in an executor, with its coordination.
pub struct Member {
    /// The component.
    pub component: Arc<ComponentCell>,
    /// Its number in the application, as the guard reports it.
    pub number: u32,
    /// Set by components that must run before it; all must be set, then all are cleared.
    pub triggers: Vec<Arc<AtomicBool>>,
    /// Set when it has run.
    pub followers: Vec<Arc<AtomicBool>>,
}

/// A group of components that one thread runs.
pub struct Executor {
    /// Name for people: that of its first component.
    pub name: String,
    /// Kind.
    pub kind: ExecutionKind,
    /// Period; zero if it has none.
    pub period: Duration,
    /// Priority, 0 (lowest) to 99.
    pub priority: u8,
    /// Scheduling policy.
    pub policy: SchedulingPolicy,
    /// What wakes it.
    pub wake: Arc<Wake>,
    /// What the fault manager asks of it.
    pub orders: Arc<Orders>,
    /// Its components, in document order.
    pub members: Vec<Member>,
    /// What is known of it, for others.
    pub status: Arc<ExecutorStatus>,
    /// Completed cycles.
    pub cycles: u64,
    /// Steps of the current cycle that have begun: first every member executes, then every member
    /// is updated. A cycle that was cut off by a lost thread goes on behind the step it was in.
    step: usize,
    /// The action whose order is being carried out.
    obeying: Option<ActionId>,
    /// It prepares a standby: what is lost then is not the component.
    prepares: bool,
}

impl Executor {
    /// An executor that has not begun.
    pub fn new(
        name: String,
        kind: ExecutionKind,
        period: Duration,
        priority: u8,
        policy: SchedulingPolicy,
        wake: Arc<Wake>,
    ) -> Self {
        let status = ExecutorStatus::new(name.clone(), kind, period, priority, policy);
        Self {
            status: Arc::new(status),
            name,
            kind,
            period,
            priority,
            policy,
            orders: Arc::new(Orders::new(Arc::clone(&wake))),
            wake,
            members: Vec::new(),
            cycles: 0,
            step: 0,
            obeying: None,
            prepares: false,
        }
    }

    /// Whether a cycle was cut off.
    pub fn is_in_cycle(&self) -> bool {
        self.step > 0
    }

    /// One cycle (or the rest of one), at `now_ns` of the container's clock.
    pub fn cycle(&mut self, now_ns: u64, lane: &Lane) {
        while self.step(now_ns, lane) {}
    }

    /// One step of a cycle; false when that was the last one.
    #[inline]
    pub fn step(&mut self, now_ns: u64, lane: &Lane) -> bool {
        let count = self.members.len();
        let step = self.step;
        if step < 2 * count {
            self.step += 1;
            if step < count {
                self.execute(step, now_ns, lane);
            } else if self.kind != ExecutionKind::Passive {
                self.update(step - count, lane);
            }
            return true;
        }
        self.step = 0;
        self.cycles += 1;
        false
    }

    /// Carries out what the fault manager has ordered.
    #[cold]
    pub fn obey(&mut self, supervisor: &Supervisor, lane: &Lane) {
        while let Some(order) = self.orders.take() {
            self.orders.hurry(CallLimit::NONE);
            let is_meant = |member: &Member| usize::try_from(member.number) == Ok(order.component);
            let Some(index) = self.members.iter().position(is_meant) else {
                continue;
            };
            let cell = Arc::clone(&self.members[index].component);
            let updates = !self.will_update(index);
            self.obeying = order.action;
            let recovered = obedience::obey(&order, &cell, self.kind, updates, supervisor, lane);
            self.obeying = None;
            if recovered {
                self.prepares = true;
                obedience::refill(order.component, supervisor, lane);
                self.prepares = false;
            }
            supervisor.attend();
        }
    }

    /// Whether the update of this member is still to come in the cycle under way.
    fn will_update(&self, index: usize) -> bool {
        self.is_in_cycle() && self.step <= self.members.len() + index
    }

    /// The thread was lost inside components of these: they are in ERROR. In an order that is the
    /// order's failure; of a standby nothing is known any more.
    pub fn after_loss(
        &mut self,
        components: &[Arc<ComponentCell>],
        lost: &LostThread,
        supervisor: &Supervisor,
    ) {
        if std::mem::take(&mut self.prepares) {
            return;
        }
        let action = self.obeying.take();
        if let Some(action) = action {
            obedience::lost(action, supervisor);
        }
        mark_lost(components, lost, action.is_some());
    }

    /// Looks after components while nothing is due.
    pub fn look_after(&self, lane: &Lane) {
        for member in &self.members {
            if let Some(mut component) = member.component.enter(lane.token(), Duration::ZERO) {
                component.look_for_stray_fault();
            }
        }
    }

    /// Counts an overrun with every component that runs.
    pub fn overran(&self, lane: &Lane) {
        for member in &self.members {
            if let Some(component) = member.component.enter(lane.token(), Duration::ZERO)
                && component.is_active()
            {
                component.overran();
            }
        }
    }

    #[inline]
    fn execute(&mut self, index: usize, now_ns: u64, lane: &Lane) {
        let member = &self.members[index];
        let Some(mut component) = member.component.enter(lane.token(), ENTER_LIMIT) else {
            return;
        };
        component.deliver(now_ns, lane.loss());
        if self.kind == ExecutionKind::Passive || !component.is_active() {
            return;
        }
        let triggered = member
            .triggers
            .iter()
            .all(|trigger| trigger.load(Ordering::Acquire));
        if !triggered {
            return;
        }
        component.execute(now_ns, lane.loss());
        drop(component);
        for trigger in &member.triggers {
            trigger.store(false, Ordering::Release);
        }
        for follower in &member.followers {
            follower.store(true, Ordering::Release);
        }
    }

    #[inline]
    fn update(&mut self, index: usize, lane: &Lane) {
        let member = &self.members[index];
        if let Some(mut component) = member.component.enter(lane.token(), ENTER_LIMIT)
            && component.is_active()
        {
            component.updated(lane.loss());
        }
    }
}
