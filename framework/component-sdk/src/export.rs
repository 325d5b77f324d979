//! What a component library exports: the descriptor, and trampolines that let no panic out.
#![allow(unsafe_code)] // the foreign side of every callback

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

use component_abi::{
    Callbacks, Header, HostContext, HostTable, Instance, LibraryDescriptor, Status, Text,
};

use crate::component::{Component, Outcome};
use crate::context::{Context, Host};
use crate::data::{EventContent, PortData};
use crate::port::{Event, PortSet};
use crate::service::Call;

/// Exports a component type from a `cdylib`.
#[macro_export]
macro_rules! export_component {
    ($component:ty) => {
        #[doc(hidden)]
        #[allow(non_upper_case_globals)]
        #[unsafe(no_mangle)]
        pub static steadfast_component: $crate::expansion::LibraryDescriptor =
            $crate::expansion::descriptor::<$component>(
                env!("CARGO_PKG_NAME"),
                env!("CARGO_PKG_VERSION"),
            );
    };
}

/// The descriptor of a library with component `C`.
pub const fn descriptor<C: Component>(
    name: &'static str,
    version: &'static str,
) -> LibraryDescriptor {
    LibraryDescriptor {
        header: Header::new(size_of::<LibraryDescriptor>()),
        name: Text::new(name),
        version: Text::new(version),
        ports: C::Ports::PORTS.as_ptr(),
        port_count: C::Ports::PORTS.len(),
        callbacks: Callbacks {
            create: Some(create::<C>),
            destroy_instance: Some(destroy_instance::<C>),
            on_initialize: Some(on_initialize::<C>),
            on_start: Some(on_start::<C>),
            on_stop: Some(on_stop::<C>),
            on_reset: Some(on_reset::<C>),
            on_error: Some(on_error::<C>),
            on_recover: Some(on_recover::<C>),
            on_destroy: Some(on_destroy::<C>),
            on_execute: Some(on_execute::<C>),
            on_updated: Some(on_updated::<C>),
            on_event: Some(on_event::<C>),
            on_period_changed: Some(on_period_changed::<C>),
            on_call: Some(on_call::<C>),
        },
    }
}

/// An instance as the library keeps it: the component and its way to the container.
struct Exported<C> {
    component: C,
    context: Context,
    host: Host,
}

thread_local! {
    /// Text and place of the last panic of this thread, from hook to trampoline.
    static LAST_PANIC: RefCell<Option<Panic>> = const { RefCell::new(None) };
    /// Whether this thread is inside a callback; panics elsewhere are printed as usual.
    static IN_CALLBACK: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

struct Panic {
    message: String,
    file: String,
    line: u32,
    column: u32,
}

unsafe extern "C" fn create<C: Component>(
    table: *const HostTable,
    context: *mut HostContext,
) -> *mut Instance {
    install_panic_hook();
    let host = Host::new(table, context);
    let made = contained(host, || {
        Box::into_raw(Box::new(Exported {
            component: C::new(C::Ports::bind(host)),
            context: host.context(),
            host,
        }))
    });
    made.map_or(std::ptr::null_mut(), |exported| exported.cast())
}

unsafe extern "C" fn destroy_instance<C: Component>(instance: *mut Instance) {
    let exported = instance.cast::<Exported<C>>();
    // SAFETY: the pointer came from `create` and the container gives it back once, alive.
    let exported = unsafe { Box::from_raw(exported) };
    let host = exported.host;
    let _ = contained(host, move || drop(exported));
}

macro_rules! callbacks {
    ($($name:ident),*) => { $(
        unsafe extern "C" fn $name<C: Component>(instance: *mut Instance) -> Status {
            // SAFETY: the container passes the pointer that `create` returned.
            unsafe { run::<C>(instance, |component, context| component.$name(context)) }
        }
    )* };
}

callbacks!(
    on_initialize,
    on_start,
    on_stop,
    on_reset,
    on_error,
    on_recover,
    on_destroy,
    on_execute,
    on_updated
);

unsafe extern "C" fn on_period_changed<C: Component>(
    instance: *mut Instance,
    period_ns: u64,
) -> Status {
    // SAFETY: the container passes the pointer that `create` returned.
    unsafe {
        run::<C>(instance, |component, context| {
            component.on_period_changed(context, period_ns)
        })
    }
}

unsafe extern "C" fn on_event<C: Component>(
    instance: *mut Instance,
    port: u32,
    data: *const u8,
    size: usize,
) -> Status {
    // SAFETY: the container passes `size` readable bytes for the time of the call.
    let content = unsafe { bytes(data, size) };
    // SAFETY: the container passes the pointer that `create` returned.
    unsafe {
        run::<C>(instance, |component, context| {
            component.on_event(context, &Event::new(port, content))
        })
    }
}

unsafe extern "C" fn on_call<C: Component>(
    instance: *mut Instance,
    port: u32,
    method: u32,
    request: *const u8,
    request_size: usize,
    reply: *mut u8,
    reply_size: usize,
) -> Status {
    // SAFETY: the container passes `request_size` readable bytes for the time of the call.
    let request = unsafe { bytes(request, request_size) };
    let reply = if reply_size == 0 {
        &mut []
    } else {
        // SAFETY: the container passes `reply_size` writable bytes that overlap nothing else.
        unsafe { std::slice::from_raw_parts_mut(reply, reply_size) }
    };
    // SAFETY: the container passes the pointer that `create` returned.
    unsafe {
        run::<C>(instance, |component, context| {
            component.on_call(context, &mut Call::new(port, method, request, reply))
        })
    }
}

/// Runs a callback of the instance behind the pointer and turns its outcome into a status.
///
/// # Safety
/// `instance` must come from `create::<C>`, be alive, and not be borrowed elsewhere.
unsafe fn run<C: Component>(
    instance: *mut Instance,
    callback: impl FnOnce(&mut C, &Context) -> Outcome,
) -> Status {
    // SAFETY: by this function's contract; the container enters an instance once at a time.
    let exported = unsafe { &mut *instance.cast::<Exported<C>>() };
    let host = exported.host;
    match contained(host, || {
        callback(&mut exported.component, &exported.context)
    }) {
        Some(Ok(())) => Status::SUCCESS,
        Some(Err(failure)) => {
            host.failed(&failure.message, "", 0, 0);
            failure.status
        }
        None => Status::PANICKED,
    }
}

/// Runs `work`; if it panics, text and place go to the container. `AssertUnwindSafe`: the
/// container never calls an instance again whose callback panicked.
fn contained<Value>(host: Host, work: impl FnOnce() -> Value) -> Option<Value> {
    IN_CALLBACK.set(true);
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    IN_CALLBACK.set(false);
    match result {
        Ok(value) => Some(value),
        Err(payload) => {
            // A payload whose own drop panics must not get another chance to do so.
            std::mem::forget(payload);
            let panic = LAST_PANIC.take().unwrap_or_else(|| Panic {
                message: "panic without a message".to_owned(),
                file: String::new(),
                line: 0,
                column: 0,
            });
            host.failed(&panic.message, &panic.file, panic.line, panic.column);
            None
        }
    }
}

/// Every library has a standard library of its own, so the hook must be set inside.
fn install_panic_hook() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let previous = panic::take_hook();
        panic::set_hook(Box::new(move |information| {
            if !IN_CALLBACK.get() {
                previous(information);
                return;
            }
            let place = information.location();
            let panic = Panic {
                message: information
                    .payload_as_str()
                    .unwrap_or("panic with a payload that is no text")
                    .to_owned(),
                file: place.map_or_else(String::new, |place| place.file().to_owned()),
                line: place.map_or(0, panic::Location::line),
                column: place.map_or(0, panic::Location::column),
            };
            LAST_PANIC.set(Some(panic));
        }));
    });
}

/// The bytes behind a foreign pointer; empty for size 0, whatever the pointer.
///
/// # Safety
/// `data` must be readable for `size` bytes during `'callback`.
unsafe fn bytes<'callback>(data: *const u8, size: usize) -> &'callback [u8] {
    if size == 0 {
        return &[];
    }
    // SAFETY: by this function's contract.
    unsafe { std::slice::from_raw_parts(data, size) }
}

/// Reads a datum out of bytes of exactly its size.
pub(crate) fn datum_from<Data: EventContent>(bytes: &[u8]) -> Option<Data> {
    // SAFETY: the length is checked; the read is unaligned; every bit pattern is a valid `Data`.
    (bytes.len() == size_of::<Data>())
        .then(|| unsafe { bytes.as_ptr().cast::<Data>().read_unaligned() })
}

/// Copies a datum into bytes of exactly its size.
pub(crate) fn copy_into<Data: PortData>(bytes: &mut [u8], datum: &Data) {
    assert_eq!(bytes.len(), size_of::<Data>());
    // SAFETY: the length is checked; the write is unaligned.
    unsafe { bytes.as_mut_ptr().cast::<Data>().write_unaligned(*datum) };
}
