//! Life-cycle operations on all components of an application, one after the other.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use system_model::fault::{Fault, FaultKind};
use system_model::life_cycle::Operation;

use crate::component::{Component, ComponentCell, OperationError, mark_lost};
use crate::guard::loss::LostThread;
use crate::lane::{Lane, Work};
use crate::supervision::Supervisor;

/// While nothing else runs a component is free at once; a busy one was abandoned.
const ENTER_LIMIT: Duration = Duration::from_millis(100);

/// What is done with a component.
#[derive(Debug, Clone, Copy)]
pub(super) enum Step {
    /// Make the instance.
    Construct,
    /// Give it what a run that died has left.
    Inherit,
    /// Prepare its standbys.
    Standby,
    /// A life-cycle operation.
    Operate(Operation),
}

/// A component that said no.
#[derive(Debug, Clone)]
pub struct Failure {
    /// Instance name.
    pub component: String,
    /// What it said.
    pub fault: Fault,
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "component '{}' failed in {}: {}\n  help: nothing was started; see its properties and the devices it opens",
            self.component, self.fault.callback, self.fault.message
        )
    }
}

/// Failures, shared with the thread that waits.
#[derive(Clone, Default)]
pub(super) struct Failures(Arc<Mutex<Vec<Failure>>>);

impl Failures {
    /// All of them.
    pub(super) fn take(&self) -> Vec<Failure> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn push(&self, failure: Failure) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(failure);
    }
}

/// Each component in turn goes through all steps.
pub(super) struct Agenda {
    components: Arc<[Arc<ComponentCell>]>,
    steps: Vec<Step>,
    last_first: bool,
    /// Components that a thread is inside of for ever: nobody may enter them.
    left_behind: LeftBehind,
    supervisor: Arc<Supervisor>,
    /// It prepares a standby: what is lost then is not the component.
    prepares: AtomicBool,
    progress: Progress,
    failures: Failures,
}

/// Components that are left behind, by their number.
pub(super) type LeftBehind = Arc<[AtomicBool]>;

/// None of so many components has been left behind.
pub(super) fn nobody(components: usize) -> LeftBehind {
    (0..components).map(|_| AtomicBool::new(false)).collect()
}

/// How far an agenda is, for the thread that waits.
#[derive(Clone)]
pub(super) struct Progress {
    /// Pairs of component and step that have begun.
    begun: Arc<AtomicUsize>,
    /// The component of the last one.
    component: Arc<AtomicUsize>,
}

impl Progress {
    /// The component that is, or was last, being dealt with.
    pub(super) fn component(&self) -> usize {
        self.component.load(Ordering::Acquire)
    }
}

impl Agenda {
    pub(super) fn new(
        components: Arc<[Arc<ComponentCell>]>,
        steps: Vec<Step>,
        last_first: bool,
        left_behind: LeftBehind,
        supervisor: Arc<Supervisor>,
    ) -> Self {
        Self {
            components,
            steps,
            last_first,
            left_behind,
            supervisor,
            prepares: AtomicBool::new(false),
            progress: Progress {
                begun: Arc::default(),
                component: Arc::default(),
            },
            failures: Failures::default(),
        }
    }

    pub(super) fn failures(&self) -> Failures {
        self.failures.clone()
    }

    pub(super) fn progress(&self) -> Progress {
        self.progress.clone()
    }

    fn perform(&self, position: usize, lane: &Lane) {
        let (index, step) = (position / self.steps.len(), position % self.steps.len());
        let index = if self.last_first {
            self.components.len() - 1 - index
        } else {
            index
        };
        if self.left_behind[index].load(Ordering::Acquire) {
            return;
        }
        self.progress.component.store(index, Ordering::Release);
        let Some(mut component) = self.components[index].enter(lane.token(), ENTER_LIMIT) else {
            return;
        };
        let result = match self.steps[step] {
            Step::Construct => component.construct(lane.loss()),
            Step::Operate(Operation::Start) if component.status().is_dormant() => return,
            Step::Operate(operation) => component.operate(operation, lane.loss()),
            Step::Inherit => {
                component.inherit(lane.loss());
                return;
            }
            Step::Standby => {
                drop(component);
                self.prepares.store(true, Ordering::Relaxed);
                if let Err(reason) = self.supervisor.prepare_standbys(index, lane.loss()) {
                    // Where time is real it is tried again in the background.
                    self.supervisor.notice(&reason);
                    self.supervisor.want_standbys(index);
                }
                self.prepares.store(false, Ordering::Relaxed);
                return;
            }
        };
        if let Err(OperationError::Failed(fault)) = result {
            self.judge(&mut component, &fault);
        }
    }

    /// A crash is contained and the rest goes on; a refusal is for the person to deal with.
    fn judge(&self, component: &mut Component, fault: &Fault) {
        if fault.kind == FaultKind::ErrorReturn {
            self.failures.push(Failure {
                component: component.name().to_string(),
                fault: fault.clone(),
            });
        } else {
            component.report_error_at_start(fault);
        }
    }
}

impl Work for Agenda {
    fn run(&mut self, lane: &Lane) {
        let all = self.components.len() * self.steps.len();
        while !lane.is_stopping() {
            let position = self.progress.begun.fetch_add(1, Ordering::AcqRel);
            if position >= all {
                return;
            }
            self.perform(position, lane);
        }
    }

    fn after_loss(&mut self, lost: &LostThread) {
        if !self.prepares.swap(false, Ordering::Relaxed) {
            mark_lost(&self.components, lost, false);
        }
    }
}
