//! What counts as a symptom, and when symptoms are a fault.

use std::time::Duration;

use super::diagnosis::ComponentSeverity;
use crate::fault::FaultKind;

/// A callback that takes three periods has made its component miss two cycles: not a late one any
/// more, and soon enough for a component downstream that tolerates a few old data.
pub const DEFAULT_DEADLINE_PERIODS: u32 = 3;

/// Deadline of a callback of a component without a period: as long as a service call may take.
pub const DEFAULT_PERIODLESS_DEADLINE: Duration = Duration::from_secs(1);

/// Deadline of `onInitialize` and `onStart`, which open devices and warm them up: as long as
/// bringing up an application may take.
pub const DEFAULT_STARTUP: Duration = Duration::from_secs(30);

/// One heartbeat may be lost to jitter and a second one to a cycle that waited for it; three are no
/// accident.
pub const DEFAULT_HEARTBEATS_MISSED: u32 = 3;

/// How symptoms of one rule become a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Judgement {
    /// The rule's own debounce; see [`super::ComponentRules::confirmation()`].
    pub confirmation: Option<Confirmation>,
    /// `latch`: only an operator's `clear` ends the fault.
    pub latched: bool,
    /// When the rule begins to act.
    pub arming: Arming,
    /// Severity of this rule's faults, where it is not that of the component.
    pub severity: Option<ComponentSeverity>,
}

/// `confirm`: so many symptoms within a time are a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Confirmation {
    /// Symptoms, at least 1.
    pub count: u32,
    /// Within this time; without it, one after the other without a good datum between them.
    pub within: Option<Duration>,
}

impl Default for Confirmation {
    /// The first symptom is the fault.
    fn default() -> Self {
        Self {
            count: 1,
            within: None,
        }
    }
}

/// `armed`: when a rule begins to act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Arming {
    /// When the application runs and the first datum has come.
    #[default]
    Running,
    /// From the beginning, while the application initialises too.
    Always,
}

/// `validity`: a field is finite and inside of an interval.
#[derive(Debug, Clone, PartialEq)]
pub struct ValidityRule {
    /// Path of the field; none means every field.
    pub field: Option<String>,
    /// Least value.
    pub minimum: Option<f64>,
    /// Largest value.
    pub maximum: Option<f64>,
    /// How symptoms become a fault.
    pub judgement: Judgement,
}

/// `freshness`: an input has a new datum often enough.
#[derive(Debug, Clone, PartialEq)]
pub struct FreshnessRule {
    /// The newest datum may be so old.
    pub maximum_age: Duration,
    /// How symptoms become a fault.
    pub judgement: Judgement,
}

/// `rate_of_change`: a field does not jump.
#[derive(Debug, Clone, PartialEq)]
pub struct RateOfChangeRule {
    /// Path of the field; none means every field.
    pub field: Option<String>,
    /// Largest change, in the field's unit per second.
    pub maximum_per_second: f64,
    /// How symptoms become a fault.
    pub judgement: Judgement,
}

/// `stuck`: a field does not stay exactly the same.
#[derive(Debug, Clone, PartialEq)]
pub struct StuckRule {
    /// Path of the field; none means that all fields together stay the same.
    pub field: Option<String>,
    /// So many equal data are a symptom, at least 2.
    pub count: u32,
    /// How symptoms become a fault.
    pub judgement: Judgement,
}

/// `exception`: what to do on a runtime exception.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExceptionRule {
    /// Which exceptions are meant.
    pub class: ExceptionClass,
    /// How they become a fault.
    pub judgement: Judgement,
}

/// A class of runtime exceptions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ExceptionClass {
    /// Every exception.
    Any,
    /// One kind.
    Kind(FaultKind),
    /// A callback that returned one of these codes.
    ReturnCodes(ReturnCodes),
}

/// Families of return codes (OPRoS), or one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ReturnCodes {
    /// 400 to 499: the caller's mistake.
    Caller,
    /// 500 to 599: the component's own mistake.
    Callee,
    /// `0x1…`: cannot be recovered.
    Unrecoverable,
    /// `0x2…`: can be recovered.
    Recoverable,
    /// Just this code.
    Code(u32),
}

impl ExceptionClass {
    /// Whether an exception belongs to the class.
    pub fn includes(self, kind: FaultKind, return_code: u32) -> bool {
        match self {
            Self::Any => true,
            Self::Kind(own) => own == kind,
            Self::ReturnCodes(codes) => {
                kind == FaultKind::ErrorReturn && codes.include(return_code)
            }
        }
    }

    /// How narrow the class is; of two that include an exception the narrower one counts.
    pub fn narrowness(self) -> u8 {
        match self {
            Self::Any => 0,
            Self::Kind(_) => 1,
            Self::ReturnCodes(ReturnCodes::Code(_)) => 3,
            Self::ReturnCodes(_) => 2,
        }
    }
}

impl ReturnCodes {
    /// Whether a code belongs to the family.
    pub fn include(self, code: u32) -> bool {
        match self {
            Self::Caller => (400..500).contains(&code),
            Self::Callee => (500..600).contains(&code),
            Self::Unrecoverable => code >> 28 == 1,
            Self::Recoverable => code >> 28 == 2,
            Self::Code(own) => own == code,
        }
    }
}

/// `fault_event`: a fault that the component itself reports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultEventRule {
    /// Name of the event.
    pub name: String,
    /// The output event port that it leaves through; none means the component's report service.
    pub port: Option<String>,
    /// How it becomes a fault.
    pub judgement: Judgement,
}

/// `watchdog`: a callback that has not returned by then is a hang.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WatchdogRule {
    /// For each callback of a cycle, an event or a service; see
    /// [`super::ComponentRules::watchdog_deadline`] for the default.
    pub deadline: Option<Duration>,
    /// For the callbacks of bringing up.
    pub startup: Duration,
    /// How a hang becomes a fault.
    pub judgement: Judgement,
}

/// `overrun`: so many period overruns are tolerated within a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverrunRule {
    /// Overruns that are no symptom.
    pub tolerated: u32,
    /// Within this time.
    pub within: Duration,
    /// How symptoms become a fault.
    pub judgement: Judgement,
}

/// `memory`: what a component has allocated in its callbacks and not freed has a bound.
///
/// Counted is what the C library's allocator gives to callbacks of the component and gets back from
/// them. What threads of the component's own allocate or free is not seen: the rule is not for a
/// component that hands memory over to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemoryRule {
    /// So many bytes, counted from the beginning of the incarnation, are no symptom; at least 1.
    pub limit_bytes: u64,
    /// How symptoms become a fault.
    pub judgement: Judgement,
}

/// `heartbeat`: work is completed in every period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HeartbeatRule {
    /// In each of these at least one `onExecute` is completed.
    pub period: Duration,
    /// So many empty periods after each other are a symptom, at least 1.
    pub missed: u32,
    /// How symptoms become a fault.
    pub judgement: Judgement,
}
