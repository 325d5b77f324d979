//! The ladder: reset, replacement, stop, emergency stop, each rung with a budget and a cost.

use std::time::Duration;

use super::diagnosis::ApplicationSeverity;
use crate::specification::ComponentSpecification;

/// Resets are counted within this time: long enough to see a fault that comes back every few
/// seconds, short enough that one fault a day never uses the budget up.
pub const DEFAULT_FAULT_WINDOW: Duration = Duration::from_secs(60);

/// A transient fault is gone after the first reset; the third one in a minute shows that it is none.
pub const DEFAULT_RETRY_MAX: u32 = 3;

/// Each reset after a dirty fault leaves an instance, a stack and a copy of the library (about 300
/// KB) in quarantine; this many are 30 MB.
pub const MAX_RETRY_MAX: u32 = 100;

/// What a robot remembers of where it is and what it was doing: after an hour somebody has moved it,
/// or the world around it.
pub const DEFAULT_PERSISTED_MAX_AGE: Duration = Duration::from_secs(60 * 60);

/// `resurrect`: recovery in place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ResurrectRule {
    /// Whether the component may be reset at all.
    pub reset: bool,
    /// Its registered memory is copied with this period, and restored before `onRecover`.
    pub backup: Option<Duration>,
    /// `persist`: the copy also outlives the container, which goes on from one that is no older than
    /// this (`max_age`).
    pub persist: Option<Duration>,
}

/// `fault`: the budget of resets, and what follows when all recovery is exhausted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaultRule {
    /// Resets within the window.
    pub retry_max: u32,
    /// The time in which resets are counted.
    pub window: Duration,
    /// Pause before each reset but the first one of a window. It does not grow.
    pub backoff: Duration,
    /// What it entails that the component is lost.
    pub severity: ApplicationSeverity,
}

impl Default for FaultRule {
    fn default() -> Self {
        Self {
            retry_max: DEFAULT_RETRY_MAX,
            window: DEFAULT_FAULT_WINDOW,
            backoff: Duration::ZERO,
            severity: ApplicationSeverity::default(),
        }
    }
}

impl FaultRule {
    /// Whether a component that fails again at once uses the budget up. The n-th reset comes at
    /// least n-1 pauses after the first one; once that is the whole window, the first reset has been
    /// forgotten when the last one comes, and the component is reset for ever.
    pub fn runs_out(&self) -> bool {
        let pauses = self.retry_max.saturating_sub(1);
        self.retry_max == 0 || self.backoff.saturating_mul(pauses) < self.window
    }
}

/// `secondary`: what takes a component's place.
#[derive(Debug, Clone, PartialEq)]
pub struct Secondary {
    /// The replacement under the primary's name, ready to be brought up.
    pub specification: ComponentSpecification,
    /// What is prepared before it is needed.
    pub preload: Preload,
}

/// How much of an instance is prepared before it is needed: of a secondary, or, by `standby`, of the
/// component itself for a reset of an instance that cannot be called any more.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Preload {
    /// Nothing. The default, as in the paper: it costs no memory.
    #[default]
    Cold,
    /// The library is loaded and the instance created.
    Loaded,
    /// The instance is initialised and kept up to date with the checkpoint.
    Warm,
}

/// `recovery`: from the detection of a fault to the first completed cycle of who took over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecoveryRule {
    /// The longest time.
    pub deadline: Duration,
}

/// What a reset costs, for the deadline of a recovery: the largest of 1500 measured resets in the
/// same process under load (0.22 ms) and, of a process, a warm standby with its claimed 99th
/// percentile, each rounded up.
pub fn declared_reset_cost(tier: IsolationTier) -> Duration {
    match tier {
        IsolationTier::Guarded => Duration::from_micros(300),
        IsolationTier::Process => Duration::from_millis(1),
    }
}

/// What a replacement costs, for the deadline of a recovery: the claims of the measurements. A
/// warm one in the same process takes 0.1 ms, a cold one (copy, load, create, initialise) 2 ms; in a
/// process of its own 0.25 ms and 5 ms. A loaded one is initialised, as in a reset.
pub fn declared_replacement_cost(preload: Preload, tier: IsolationTier) -> Duration {
    match (preload, tier) {
        (Preload::Warm, IsolationTier::Guarded) => Duration::from_micros(100),
        (Preload::Warm, IsolationTier::Process) => Duration::from_micros(250),
        (Preload::Loaded, tier) => declared_reset_cost(tier),
        (Preload::Cold, IsolationTier::Guarded) => Duration::from_millis(2),
        (Preload::Cold, IsolationTier::Process) => Duration::from_millis(5),
    }
}

/// As long as a person would wait for a robot that does nothing visible.
pub const DEFAULT_HANDLE_DEADLINE: Duration = Duration::from_secs(10);

/// `handle`: a behaviour tree of the application handles the fault, after resets and secondaries and
/// before the severity of the loss.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HandleRule {
    /// Name of the tree.
    pub tree: String,
    /// By then it must have ended.
    pub deadline: Duration,
}

/// `adapt`: a task that is done in another way when what runs does not do any more. Of an
/// application: the task is watched over. Of a component: the last rung before the severity of the
/// loss; the task is to go on without the component.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct AdaptRule {
    /// File of the task.
    pub task: String,
    /// The robot of the task on which the application runs; none where there is only one.
    pub robot: Option<String>,
}

/// `actuator`: the component moves something.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ActuatorRule {
    /// How it stops in an emergency.
    pub stop_category: StopCategory,
    /// What its hardware is told while no container runs.
    pub safe_states: Vec<SafeStateRule>,
}

/// A command to hardware is a frame of a serial line or two; more is no safe state but a program.
pub const MAX_SAFE_STATE_BYTES: usize = 256;

/// `safe_state` of an actuator: bytes that make its hardware safe, for hardware that does not stop by
/// itself when commands fail to come.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SafeStateRule {
    /// Path of the device.
    pub device: String,
    /// What is written to it.
    pub bytes: Vec<u8>,
    /// How often.
    pub period: Duration,
}

/// The stop categories of IEC 60204-1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StopCategory {
    /// 0: power is taken away at once.
    PowerOff,
    /// 1: the motion is stopped under control, then power is taken away.
    ControlledThenOff,
    /// 2: the motion is stopped under control and power stays on.
    Controlled,
}

/// What a command port reads instead of stale data, and in an emergency stop.
#[derive(Debug, Clone, PartialEq)]
pub struct SafeValue {
    /// Path of the field; none means every field.
    pub field: Option<String>,
    /// The value.
    pub value: f64,
}

/// `isolation`: where a component runs.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct IsolationRule {
    /// The tier.
    pub tier: IsolationTier,
    /// Components of the same group share a host process.
    pub group: Option<String>,
    /// Bounds of the host process; of a group those of the component that is started first.
    pub limits: ProcessLimits,
}

/// Bounds of a host process; what is not said is not bounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProcessLimits {
    /// Private writable memory, in bytes.
    pub memory_bytes: Option<u64>,
    /// Open files.
    pub open_files: Option<u64>,
    /// Processor time since the process was started, in seconds.
    pub processor_time_s: Option<u64>,
    /// Whether the system calls are refused that reach beyond the process.
    pub filters_system_calls: bool,
}

impl Default for ProcessLimits {
    fn default() -> Self {
        Self {
            memory_bytes: None,
            open_files: None,
            processor_time_s: None,
            filters_system_calls: true,
        }
    }
}

/// How far a component is separated from the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum IsolationTier {
    /// In the container, behind the guard. The default: a hop costs nothing, and all but corrupted
    /// memory is survived.
    #[default]
    Guarded,
    /// In a host process.
    Process,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_runs_out_while_the_window_is_longer_than_its_pauses() {
        let rule = |retry_max, window, backoff| FaultRule {
            retry_max,
            window: Duration::from_secs(window),
            backoff: Duration::from_secs(backoff),
            severity: ApplicationSeverity::Local,
        };
        assert!(FaultRule::default().runs_out());
        assert!(rule(0, 0, 9).runs_out(), "nothing is ever retried");
        assert!(
            rule(1, 1, 9).runs_out(),
            "the first reset waits for nothing"
        );
        assert!(rule(3, 10, 4).runs_out());
        assert!(!rule(3, 10, 5).runs_out());
        assert!(!rule(1, 0, 0).runs_out(), "nothing lies within no time");
    }
}
