//! The kinds of fault that can be injected, with what each needs to be known.

use std::time::Duration;

/// The OPRoS callbacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CallbackName {
    /// `onInitialize`.
    Initialize,
    /// `onStart`.
    Start,
    /// `onStop`.
    Stop,
    /// `onReset`.
    Reset,
    /// `onError`.
    Error,
    /// `onRecover`.
    Recover,
    /// `onDestroy`.
    Destroy,
    /// `onExecute`.
    Execute,
    /// `onUpdated`.
    Updated,
    /// `onEvent`.
    Event,
    /// `onPeriodChanged`.
    PeriodChanged,
}

/// What a callback does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Misbehaviour {
    /// It panics.
    Panic,
    /// It writes to memory that is not there (SIGSEGV).
    Segfault,
    /// It reads memory that has no backing (SIGBUS).
    BusError,
    /// It divides by zero (SIGFPE).
    DivideByZero,
    /// It runs into an instruction that does not exist (SIGILL).
    IllegalInstruction,
    /// It calls `abort()`.
    Abort,
    /// It uses up its stack.
    StackOverflow,
    /// It calls `exit()` with this code.
    Exit(i32),
    /// It does not return.
    Hang,
    /// It takes so much longer.
    Slow(Duration),
    /// It loses so many bytes in every call.
    Leak(u64),
    /// It returns this status instead of its own.
    ErrorReturn(u32),
}

/// What happens to the data of a port.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distortion {
    /// They are this value.
    OutOfRange(f64),
    /// They are no number; integers are left alone.
    NotANumber,
    /// They stay what they are when it begins.
    Stuck,
    /// They are larger by this.
    Offset(f64),
    /// They grow by so much a second.
    Drift(f64),
    /// Gaussian noise of this standard deviation is added.
    Noise(f64),
    /// They are lost.
    Drop,
    /// They come so much later.
    Delay(Duration),
    /// They come twice.
    Duplicate,
}

/// A fault of the simulated hardware.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WorldFault {
    /// The sonar in this socket of the board does not answer: it reads 0.
    UnplugSonar(usize),
    /// The driver of one side's motors has no power.
    MotorDriverOff(RobotSide),
    /// One side's encoder counts no more.
    EncoderDead(RobotSide),
    /// Smoke in front of the lens, from 0, clear, to 1, nothing but grey.
    CameraSmoke(f64),
}

/// Left or right side of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RobotSide {
    /// Left.
    Left,
    /// Right.
    Right,
}

/// What of the container's own handling fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ContainerFailure {
    /// The next load of the component's library, or of its secondary's.
    LibraryMissing,
    /// The checkpoint that is restored next was damaged.
    CheckpointCorrupt,
    /// The next recovery.
    RecoveryFails,
}

impl CallbackName {
    /// All of them, with the names that OPRoS gives them.
    pub const ALL: [(&'static str, Self); 11] = [
        ("onInitialize", Self::Initialize),
        ("onStart", Self::Start),
        ("onStop", Self::Stop),
        ("onReset", Self::Reset),
        ("onError", Self::Error),
        ("onRecover", Self::Recover),
        ("onDestroy", Self::Destroy),
        ("onExecute", Self::Execute),
        ("onUpdated", Self::Updated),
        ("onEvent", Self::Event),
        ("onPeriodChanged", Self::PeriodChanged),
    ];
}

impl Misbehaviour {
    /// Its KIND in injection files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Panic => "panic",
            Self::Segfault => "segfault",
            Self::BusError => "bus_error",
            Self::DivideByZero => "divide_by_zero",
            Self::IllegalInstruction => "illegal_instruction",
            Self::Abort => "abort",
            Self::StackOverflow => "stack_overflow",
            Self::Exit(_) => "exit",
            Self::Hang => "hang",
            Self::Slow(_) => "slow",
            Self::Leak(_) => "leak",
            Self::ErrorReturn(_) => "error_return",
        }
    }
}

impl Distortion {
    /// Its KIND in injection files.
    pub fn name(self) -> &'static str {
        match self {
            Self::OutOfRange(_) => "out_of_range",
            Self::NotANumber => "not_a_number",
            Self::Stuck => "stuck",
            Self::Offset(_) => "offset",
            Self::Drift(_) => "drift",
            Self::Noise(_) => "noise",
            Self::Drop => "drop",
            Self::Delay(_) => "delay",
            Self::Duplicate => "duplicate",
        }
    }
}

impl WorldFault {
    /// Its KIND in injection files.
    pub fn name(self) -> &'static str {
        match self {
            Self::UnplugSonar(_) => "unplug_sonar",
            Self::MotorDriverOff(_) => "motor_driver_off",
            Self::EncoderDead(_) => "encoder_dead",
            Self::CameraSmoke(_) => "camera_smoke",
        }
    }
}

impl ContainerFailure {
    /// Its KIND in injection files.
    pub fn name(self) -> &'static str {
        match self {
            Self::LibraryMissing => "library_missing",
            Self::CheckpointCorrupt => "checkpoint_corrupt",
            Self::RecoveryFails => "recovery_fails",
        }
    }
}
