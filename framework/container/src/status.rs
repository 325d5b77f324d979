//! What the container knows of each component, readable from any thread at any time.

mod executor;
mod meter;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, AtomicUsize, Ordering};

use system_model::life_cycle::LifeCycleState;

pub use executor::ExecutorStatus;
pub use meter::{Figures, Meter};

/// Figures of one component. Each counter has one writer at a time: the thread inside it.
#[derive(Debug)]
pub struct ComponentStatus {
    /// Instance name.
    pub name: String,
    state: AtomicU8,
    incarnation: AtomicU32,
    cycles: AtomicU64,
    overruns: AtomicU64,
    faults: AtomicU64,
    last_fault: Mutex<Option<String>>,
    /// Whether it runs in a process of its own.
    in_host: AtomicBool,
    /// Which of its libraries it is of: its own (0) or that of a secondary (from 1).
    variant: AtomicUsize,
    /// Of an instance that stands by, and is not seen.
    standby: bool,
    /// A task is being done without it: it does not run, and is not missed.
    dormant: AtomicBool,
    /// Bytes that its callbacks have allocated and not freed, where a rule asks.
    allocated_bytes: AtomicU64,
    /// Until when it is in a callback that hangs, in nanoseconds of a simulated clock.
    hangs_until_ns: AtomicU64,
    /// When an injected misbehaviour acted last, and when the component had completed its first
    /// cycle after its last recovery, in nanoseconds of the container's clock; 0: never.
    misbehaved_ns: AtomicU64,
    works_since_ns: AtomicU64,
}

const STATES: [LifeCycleState; 6] = [
    LifeCycleState::Created,
    LifeCycleState::Ready,
    LifeCycleState::Active,
    LifeCycleState::Inactive,
    LifeCycleState::Error,
    LifeCycleState::Destroyed,
];

impl ComponentStatus {
    /// A component that was just created.
    pub fn new(name: String) -> Self {
        Self {
            name,
            state: AtomicU8::new(0),
            incarnation: AtomicU32::new(1),
            cycles: AtomicU64::new(0),
            overruns: AtomicU64::new(0),
            faults: AtomicU64::new(0),
            last_fault: Mutex::new(None),
            in_host: AtomicBool::new(false),
            variant: AtomicUsize::new(0),
            standby: false,
            dormant: AtomicBool::new(false),
            allocated_bytes: AtomicU64::new(0),
            hangs_until_ns: AtomicU64::new(0),
            misbehaved_ns: AtomicU64::new(0),
            works_since_ns: AtomicU64::new(0),
        }
    }

    /// An instance that stands by for the component of this name.
    pub fn standby(name: String) -> Self {
        Self {
            standby: true,
            ..Self::new(name)
        }
    }

    /// Whether it is one that stands by.
    pub fn is_standby(&self) -> bool {
        self.standby
    }

    /// Whether it does not run because a task is being done without it.
    pub fn is_dormant(&self) -> bool {
        self.dormant.load(Ordering::Relaxed)
    }

    pub(crate) fn set_dormant(&self, dormant: bool) {
        self.dormant.store(dormant, Ordering::Relaxed);
    }

    /// Life-cycle state.
    pub fn state(&self) -> LifeCycleState {
        STATES[usize::from(self.state.load(Ordering::Acquire)) % STATES.len()]
    }

    pub(crate) fn set_state(&self, state: LifeCycleState) {
        let index = STATES.iter().position(|other| *other == state);
        let index = index.and_then(|index| u8::try_from(index).ok());
        self.state.store(index.unwrap_or(0), Ordering::Release);
    }

    /// Name of its isolation tier.
    pub fn tier(&self) -> &'static str {
        if self.in_host.load(Ordering::Relaxed) {
            "process"
        } else {
            "guarded"
        }
    }

    pub(crate) fn set_in_host(&self, in_host: bool) {
        self.in_host.store(in_host, Ordering::Relaxed);
    }

    /// Which of its libraries it is of: its own (0) or that of a secondary (from 1).
    pub fn variant(&self) -> usize {
        self.variant.load(Ordering::Relaxed)
    }

    pub(crate) fn set_variant(&self, variant: usize) {
        self.variant.store(variant, Ordering::Relaxed);
    }

    /// Which instance of this component it is, counted from 1.
    pub fn incarnation(&self) -> u32 {
        self.incarnation.load(Ordering::Relaxed)
    }

    /// Whether it is in a callback that hangs, at this time of a simulated clock: nobody can know
    /// yet.
    pub(crate) fn hangs_at(&self, now_ns: u64) -> bool {
        now_ns < self.hangs_until_ns.load(Ordering::Relaxed)
    }

    pub(crate) fn set_hanging_until(&self, until_ns: u64) {
        self.hangs_until_ns.store(until_ns, Ordering::Relaxed);
    }

    /// When an injected misbehaviour that ended or failed a callback acted last, taken on the
    /// component's stack just before it did, in nanoseconds of the container's clock; 0: never.
    pub fn misbehaved_ns(&self) -> u64 {
        self.misbehaved_ns.load(Ordering::Acquire)
    }

    pub(crate) fn set_misbehaved_ns(&self, time_ns: u64) {
        self.misbehaved_ns.store(time_ns, Ordering::Release);
    }

    /// When the first cycle after the last recovery was completed (its `onExecute` had returned), in
    /// nanoseconds of the container's clock; 0: it was never recovered.
    pub fn works_since_ns(&self) -> u64 {
        self.works_since_ns.load(Ordering::Acquire)
    }

    pub(crate) fn set_works_since_ns(&self, time_ns: u64) {
        self.works_since_ns.store(time_ns, Ordering::Release);
    }

    pub(crate) fn set_incarnation(&self, incarnation: u32) {
        self.incarnation.store(incarnation, Ordering::Relaxed);
    }

    /// Completed `onExecute`.
    pub fn cycles(&self) -> u64 {
        self.cycles.load(Ordering::Relaxed)
    }

    pub(crate) fn count_cycle(&self) {
        increase(&self.cycles);
    }

    /// Cycles of its executor that took longer than the period.
    pub fn overruns(&self) -> u64 {
        self.overruns.load(Ordering::Relaxed)
    }

    pub(crate) fn count_overrun(&self) {
        increase(&self.overruns);
    }

    /// Bytes that callbacks of this incarnation have allocated and not freed; 0 where no rule asks.
    pub fn allocated_bytes(&self) -> u64 {
        self.allocated_bytes.load(Ordering::Relaxed)
    }

    pub(crate) fn set_allocated_bytes(&self, bytes: u64) {
        self.allocated_bytes.store(bytes, Ordering::Relaxed);
    }

    /// Faults so far.
    pub fn faults(&self) -> u64 {
        self.faults.load(Ordering::Relaxed)
    }

    /// The last fault, in words.
    pub fn last_fault(&self) -> Option<String> {
        self.last_fault.lock().ok()?.clone()
    }

    pub(crate) fn count_fault(&self, text: String) {
        increase(&self.faults);
        if let Ok(mut last) = self.last_fault.lock() {
            *last = Some(text);
        }
    }
}

/// A plain store instead of a locked addition: there is one writer at a time.
fn increase(counter: &AtomicU64) {
    counter.store(counter.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
}
