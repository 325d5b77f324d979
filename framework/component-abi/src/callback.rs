//! What the container calls: the OPRoS callbacks of one component.

use crate::host::{HostContext, HostTable};
use crate::status::Status;

/// A component instance; its inside belongs to the library.
#[repr(C)]
pub struct Instance {
    _opaque: [u8; 0],
}

/// A callback without arguments.
pub type Callback = unsafe extern "C" fn(instance: *mut Instance) -> Status;

/// The callbacks of a component. A null callback succeeds without doing anything; `create` and
/// `destroy_instance` must be there. None may unwind: the SDK catches panics inside the library.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Callbacks {
    /// Makes an instance; null means it could not. The host table and the context stay valid for
    /// as long as the instance lives; the context names this instance in every host call.
    pub create: Option<
        unsafe extern "C" fn(host: *const HostTable, context: *mut HostContext) -> *mut Instance,
    >,
    /// Frees an instance. Never called for one that trapped.
    pub destroy_instance: Option<unsafe extern "C" fn(instance: *mut Instance)>,
    /// `onInitialize`: CREATED -> READY.
    pub on_initialize: Option<Callback>,
    /// `onStart`: READY or INACTIVE -> ACTIVE.
    pub on_start: Option<Callback>,
    /// `onStop`: ACTIVE -> INACTIVE.
    pub on_stop: Option<Callback>,
    /// `onReset`.
    pub on_reset: Option<Callback>,
    /// `onError`: called once when the instance goes to ERROR and can still be called.
    pub on_error: Option<Callback>,
    /// `onRecover`: ERROR -> READY; registered memory has been restored.
    pub on_recover: Option<Callback>,
    /// `onDestroy`, before `destroy_instance`.
    pub on_destroy: Option<Callback>,
    /// `onExecute`: once a cycle.
    pub on_execute: Option<Callback>,
    /// `onUpdated`: once a cycle, after every component of the executor has executed.
    pub on_updated: Option<Callback>,
    /// `onEvent`: an event arrived at input `port`; `data` holds `size` bytes of its type.
    pub on_event: Option<
        unsafe extern "C" fn(
            instance: *mut Instance,
            port: u32,
            data: *const u8,
            size: usize,
        ) -> Status,
    >,
    /// `onPeriodChanged`: the period in nanoseconds; 0 for components without one. Called once
    /// before `onInitialize` and at every change.
    pub on_period_changed:
        Option<unsafe extern "C" fn(instance: *mut Instance, period_ns: u64) -> Status>,
    /// A method of the provided service `port` was called. `request` holds `request_size` bytes;
    /// the answer of `reply_size` bytes is written to `reply`.
    pub on_call: Option<
        unsafe extern "C" fn(
            instance: *mut Instance,
            port: u32,
            method: u32,
            request: *const u8,
            request_size: usize,
            reply: *mut u8,
            reply_size: usize,
        ) -> Status,
    >,
}

impl Callbacks {
    /// All null: to be filled in.
    pub const NONE: Self = Self {
        create: None,
        destroy_instance: None,
        on_initialize: None,
        on_start: None,
        on_stop: None,
        on_reset: None,
        on_error: None,
        on_recover: None,
        on_destroy: None,
        on_execute: None,
        on_updated: None,
        on_event: None,
        on_period_changed: None,
        on_call: None,
    };
}
