//! What can go wrong with a component, as the container saw it.

use std::fmt;
use std::time::Duration;

/// A kind of fault; its name is part of the event file's format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FaultKind {
    /// The callback panicked.
    Panic,
    /// Access to memory that is not there or not allowed (SIGSEGV).
    Segfault,
    /// Access to memory that has no backing (SIGBUS).
    BusError,
    /// Division by zero or overflow of a division (SIGFPE).
    DivideByZero,
    /// An instruction that does not exist, or a deliberate trap (SIGILL, SIGTRAP).
    IllegalInstruction,
    /// `abort()`.
    Abort,
    /// The stack's guard area was hit.
    StackOverflow,
    /// `exit()` or the like.
    Exit,
    /// A callback returned a failure.
    ErrorReturn,
    /// The component passed memory to a host service that is not accessible.
    BadPointer,
    /// The component itself reported a fault.
    Reported,
    /// A callback did not return before its deadline.
    Hang,
    /// The process that the component ran in has ended.
    HostEnded,
    /// A value outside its interval, or not finite.
    OutOfRange,
    /// A datum of another size than its type has.
    WrongSize,
    /// An input got nothing new for too long.
    Stale,
    /// A value jumped.
    RateOfChange,
    /// A value stayed exactly the same for too long.
    Stuck,
    /// An executor did not finish its cycles within their period, too often.
    Overrun,
    /// No work was completed for too long.
    HeartbeatMissed,
    /// More memory was allocated, and not freed, than the component is allowed.
    MemoryExceeded,
    /// What the process does differs from what its model says.
    ProcessModel,
    /// A voter's source disagrees with the others.
    VotingDissent,
    /// A node of a behaviour tree could not do its work.
    TreeError,
    /// A tick of a behaviour tree did not end before its deadline, or goes round in circles.
    TickOverrun,
    /// Nothing went wrong: an operator ordered something.
    OperatorOrder,
}

impl FaultKind {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Panic => "panic",
            Self::Segfault => "segfault",
            Self::BusError => "bus_error",
            Self::DivideByZero => "divide_by_zero",
            Self::IllegalInstruction => "illegal_instruction",
            Self::Abort => "abort",
            Self::StackOverflow => "stack_overflow",
            Self::Exit => "exit",
            Self::ErrorReturn => "error_return",
            Self::BadPointer => "bad_pointer",
            Self::Reported => "reported",
            Self::Hang => "hang",
            Self::HostEnded => "host_ended",
            Self::OutOfRange => "out_of_range",
            Self::WrongSize => "wrong_size",
            Self::Stale => "stale",
            Self::RateOfChange => "rate_of_change",
            Self::Stuck => "stuck",
            Self::Overrun => "overrun",
            Self::HeartbeatMissed => "heartbeat_missed",
            Self::MemoryExceeded => "memory_exceeded",
            Self::ProcessModel => "process_model",
            Self::VotingDissent => "voting_dissent",
            Self::TreeError => "tree_error",
            Self::TickOverrun => "tick_overrun",
            Self::OperatorOrder => "operator_order",
        }
    }
}

impl fmt::Display for FaultKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// One fault of one component.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// What kind.
    pub kind: FaultKind,
    /// The callback it happened in, as OPRoS names it.
    pub callback: &'static str,
    /// What was seen, for a person: panic text, status code, address.
    pub message: String,
    /// File, line and column in the component's source, where a panic tells.
    pub place: Option<(String, u32, u32)>,
    /// Whether the thread was lost with the component, because the fault hit in the C library.
    pub thread_lost: bool,
    /// What the callback returned, for [`FaultKind::ErrorReturn`]; 0 else.
    pub return_code: u32,
    /// How long it had lasted when it was seen: the limit of a callback that hung; zero else.
    pub lasted: Duration,
    /// The signal and the address it was about, for a trap.
    pub signal: Option<SignalEvidence>,
}

impl Fault {
    /// A fault of which no more is known.
    pub fn new(kind: FaultKind, callback: &'static str, message: String) -> Self {
        Self {
            kind,
            callback,
            message,
            place: None,
            thread_lost: false,
            return_code: 0,
            lasted: Duration::ZERO,
            signal: None,
        }
    }
}

/// What the processor said of a trap.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignalEvidence {
    /// Name of the signal.
    pub name: &'static str,
    /// `si_code`.
    pub code: i32,
    /// `si_addr`: the address that could not be accessed, or the faulting instruction. It differs
    /// from run to run.
    pub address: usize,
}
