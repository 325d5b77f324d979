//! The component trait: the OPRoS callbacks, each with a default that succeeds.

use std::fmt;

use component_abi::Status;

use crate::context::Context;
use crate::port::{Event, PortSet};
use crate::service::Call;

/// What a callback returns.
pub type Outcome = Result<(), Failure>;

/// A component: constructed with its ports, then called by the container.
///
/// Callbacks of one instance never run at the same time. A failure of `on_execute` or
/// `on_updated`, a panic or a trap puts the instance into ERROR; what follows is the integrator's
/// decision.
pub trait Component: Sized + 'static {
    /// The ports; usually a struct with `#[derive(Ports)]`.
    type Ports: PortSet;

    /// Makes an instance. Properties are readable from `on_initialize` on.
    fn new(ports: Self::Ports) -> Self;

    /// Reads properties, opens devices. CREATED -> READY.
    fn on_initialize(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// About to be executed. READY or INACTIVE -> ACTIVE.
    fn on_start(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// No longer executed. ACTIVE -> INACTIVE; the input queues are cleared afterwards.
    fn on_stop(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// Back to the state after construction.
    fn on_reset(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// A failure put this instance into ERROR.
    fn on_error(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// ERROR -> READY; memory registered by [`Context::critical`] has been restored.
    fn on_recover(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// The last call.
    fn on_destroy(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// One cycle of work.
    fn on_execute(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// After every component of the same executor has executed in this cycle.
    fn on_updated(&mut self, _context: &Context) -> Outcome {
        Ok(())
    }
    /// An event arrived; [`crate::EventInput::content`] tells whether it came by that port.
    fn on_event(&mut self, _context: &Context, _event: &Event<'_>) -> Outcome {
        Ok(())
    }
    /// The period of execution is now `period_ns` nanoseconds (0: none).
    fn on_period_changed(&mut self, _context: &Context, _period_ns: u64) -> Outcome {
        Ok(())
    }
    /// A method of a provided service was called.
    fn on_call(&mut self, _context: &Context, _call: &mut Call<'_>) -> Outcome {
        Err(Failure::new(
            Status::UNSUPPORTED_METHOD,
            "this component provides no service",
        ))
    }
}

/// Why a callback did not succeed: a status code of the OPRoS families and a text for the person
/// who reads the verdict.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// The code.
    pub status: Status,
    /// What failed.
    pub message: String,
}

impl Failure {
    /// A failure with a code. A success code is turned into CALLEE_ERROR.
    pub fn new(status: Status, message: impl Into<String>) -> Self {
        let status = if status.is_success() {
            Status::CALLEE_ERROR
        } else {
            status
        };
        Self {
            status,
            message: message.into(),
        }
    }

    /// A failure of the component's own (INTERNAL_FAULT).
    pub fn internal(message: impl Into<String>) -> Self {
        Self::new(Status::INTERNAL_FAULT, message)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} ({})", self.message, self.status)
    }
}

impl std::error::Error for Failure {}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::internal(error.to_string())
    }
}
