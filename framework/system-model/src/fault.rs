//! What can go wrong with a component, as the container saw it.

use std::fmt;

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
}
