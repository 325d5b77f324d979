//! What a component is called with, and how that ends.

use component_abi::Status;

use super::interpose::Exit;
use super::trap::Trap;

/// A callback with its arguments.
#[derive(Debug, Clone, Copy)]
pub enum Callback {
    /// Makes the instance.
    Create,
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
    /// `onPeriodChanged`.
    PeriodChanged(u64),
    /// `onEvent`: port, content, size.
    Event(u32, *const u8, usize),
    /// A service method.
    Call(ServiceCall),
    /// Frees the instance.
    DestroyInstance,
}

/// A call of a provided method; the memory must stay valid until the callback is over.
#[derive(Debug, Clone, Copy)]
pub struct ServiceCall {
    /// Index of the provided port.
    pub port: u32,
    /// Index of the method in the provider's list.
    pub method: u32,
    /// Request bytes.
    pub request: *const u8,
    /// Their number.
    pub request_size: usize,
    /// Place for the reply.
    pub reply: *mut u8,
    /// Its size.
    pub reply_size: usize,
}

/// How a callback ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// It returned.
    Returned(Status),
    /// It trapped; the instance is quarantined.
    Trapped(Trap),
    /// It called `abort`, `exit` or the like; the instance is quarantined.
    Left(Exit),
    /// It cannot be called: it has ended before.
    Gone,
    /// The process that it runs in has ended.
    HostEnded,
}
