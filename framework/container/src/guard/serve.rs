//! The component's side of a call: receives callbacks on the component's own stack and makes them.

use std::ptr;

use component_abi::{Callbacks, Instance, Status};
use corosensei::Yielder;

use super::callback::Callback;
use super::host::HostSide;
use super::trap::Ended;
use super::{injection, table};

/// What goes into the coroutine: in one register, because a larger value would be written and
/// read again through memory on every call. Arguments wait in the host side.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub(super) enum Input {
    /// Run the callback that the host side names.
    Callback,
    /// Run `onExecute`, `onUpdated`: the two calls of every cycle.
    Execute,
    Updated,
    /// Misbehave as the host side says, then perhaps run the callback that it names.
    Injected,
    /// The answer to what was asked is in the host side.
    Reply,
    End,
}

/// What comes out of it, likewise.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Yielded {
    pub(super) what: What,
    pub(super) status: Status,
}

#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub(super) enum What {
    /// The callback returned the status.
    Returned,
    /// The host side has a request.
    Asked,
    /// The component left; the host side knows how.
    Left,
}

const _: () = assert!(size_of::<Yielded>() <= size_of::<usize>());

/// Runs on the component's stack: receives callbacks, calls them, hands the result back.
pub(super) fn serve(
    side: &HostSide,
    callbacks: &Callbacks,
    yielder: &Yielder<Input, Yielded>,
    first: Input,
) -> Ended {
    side.set_yielder(yielder);
    let mut input = first;
    loop {
        let status = match input {
            Input::Execute => plain(callbacks.on_execute, side.instance()),
            Input::Updated => plain(callbacks.on_updated, side.instance()),
            Input::Callback => invoke(side, callbacks, side.callback()),
            Input::Injected => side
                .take_injection()
                .and_then(|misbehaviour| injection::misbehave(side, misbehaviour))
                .unwrap_or_else(|| invoke(side, callbacks, side.callback())),
            // A reply without a question does not happen; ending is the safe answer.
            Input::Reply | Input::End => return Ended::Asked,
        };
        input = yielder.suspend(Yielded {
            what: What::Returned,
            status,
        });
    }
}

/// Calls the component, for all callbacks.
#[cold]
fn invoke(side: &HostSide, callbacks: &Callbacks, callback: Callback) -> Status {
    let instance = side.instance();
    match callback {
        Callback::Create => create(side, callbacks),
        _ if instance.is_null() => Status::PRECONDITION_NOT_MET,
        Callback::Execute => plain(callbacks.on_execute, instance),
        Callback::Updated => plain(callbacks.on_updated, instance),
        Callback::Initialize => plain(callbacks.on_initialize, instance),
        Callback::Start => plain(callbacks.on_start, instance),
        Callback::Stop => plain(callbacks.on_stop, instance),
        Callback::Reset => plain(callbacks.on_reset, instance),
        Callback::Error => plain(callbacks.on_error, instance),
        Callback::Recover => plain(callbacks.on_recover, instance),
        Callback::Destroy => plain(callbacks.on_destroy, instance),
        Callback::PeriodChanged(period_ns) => match callbacks.on_period_changed {
            // SAFETY: the instance was made by this library's `create` and is alive.
            Some(function) => unsafe { function(instance, period_ns) },
            None => Status::SUCCESS,
        },
        Callback::Event(port, data, size) => match callbacks.on_event {
            // SAFETY: as above; the caller of `Guarded::call` keeps the content valid.
            Some(function) => unsafe { function(instance, port, data, size) },
            None => Status::SUCCESS,
        },
        Callback::Call(call) => match callbacks.on_call {
            // SAFETY: as above; the caller keeps request and reply valid.
            Some(function) => unsafe {
                function(
                    instance,
                    call.port,
                    call.method,
                    call.request,
                    call.request_size,
                    call.reply,
                    call.reply_size,
                )
            },
            None => Status::UNSUPPORTED_METHOD,
        },
        Callback::DestroyInstance => destroy_instance(side, callbacks, instance),
    }
}

#[inline]
fn plain(function: Option<component_abi::callback::Callback>, instance: *mut Instance) -> Status {
    match function {
        _ if instance.is_null() => Status::PRECONDITION_NOT_MET,
        // SAFETY: the instance was made by this library's `create` and is alive.
        Some(function) => unsafe { function(instance) },
        None => Status::SUCCESS,
    }
}

fn create(side: &HostSide, callbacks: &Callbacks) -> Status {
    let Some(function) = callbacks.create else {
        return Status::UNSUPPORTED_METHOD;
    };
    // SAFETY: the table is static; the context is this instance's host side, which outlives it.
    let instance = unsafe { function(&raw const table::TABLE, side.context()) };
    side.set_instance(instance);
    if instance.is_null() {
        Status::CALLEE_ERROR
    } else {
        Status::SUCCESS
    }
}

fn destroy_instance(side: &HostSide, callbacks: &Callbacks, instance: *mut Instance) -> Status {
    side.set_instance(ptr::null_mut());
    if let Some(function) = callbacks.destroy_instance {
        // SAFETY: the instance is alive and is forgotten here, so this happens once.
        unsafe { function(instance) };
    }
    Status::SUCCESS
}
