//! The host table: the functions that a component calls.

use component_abi::{Header, HostContext, HostTable, Status, Text};

use super::foreign::{ForeignBytes, ForeignBytesMut, ForeignText};
use super::host::{HostSide, Request};

/// The table that every component gets.
pub(super) static TABLE: HostTable = HostTable {
    header: Header::new(size_of::<HostTable>()),
    read,
    write,
    raise,
    call,
    property,
    now_ns,
    log,
    critical,
    report_fault,
    failed,
    open_device,
};

fn ask(context: *mut HostContext, request: Request) -> Status {
    status(ask_number(context, request))
}

fn status(answer: u64) -> Status {
    u32::try_from(answer).map_or(Status::INTERNAL_FAULT, Status)
}

/// Asks without leaving the component's stack.
#[inline]
fn ask_here(context: *mut HostContext, request: &Request) -> u64 {
    // SAFETY: as in `ask_number`.
    match unsafe { context.cast::<HostSide>().as_ref() } {
        Some(side) => side.answer_here(request),
        None => u64::from(Status::INPUT_NULL.0),
    }
}

fn ask_number(context: *mut HostContext, request: Request) -> u64 {
    // SAFETY: null, or the host side that this instance was created with; it is leaked, not freed,
    // when the instance is quarantined. A made-up pointer faults here, on the component's stack.
    match unsafe { context.cast::<HostSide>().as_ref() } {
        Some(side) => side.ask(request),
        None => u64::from(Status::INPUT_NULL.0),
    }
}

unsafe extern "C" fn read(
    context: *mut HostContext,
    port: u32,
    data: *mut u8,
    size: usize,
) -> Status {
    let request = Request::Read(port, ForeignBytesMut::new(data, size));
    status(ask_here(context, &request))
}

unsafe extern "C" fn write(
    context: *mut HostContext,
    port: u32,
    data: *const u8,
    size: usize,
) -> Status {
    let request = Request::Write(port, ForeignBytes::new(data, size));
    status(ask_here(context, &request))
}

unsafe extern "C" fn raise(
    context: *mut HostContext,
    port: u32,
    data: *const u8,
    size: usize,
) -> Status {
    ask(context, Request::Raise(port, ForeignBytes::new(data, size)))
}

unsafe extern "C" fn call(
    context: *mut HostContext,
    port: u32,
    method: u32,
    request: *const u8,
    request_size: usize,
    reply: *mut u8,
    reply_size: usize,
    deadline_ns: u64,
) -> Status {
    let request = ForeignBytes::new(request, request_size);
    let reply = ForeignBytesMut::new(reply, reply_size);
    ask(
        context,
        Request::Call(port, method, request, reply, deadline_ns),
    )
}

unsafe extern "C" fn property(
    context: *mut HostContext,
    name: Text,
    value: *mut u8,
    capacity: usize,
    length: *mut usize,
) -> Status {
    let length = ForeignBytesMut::new(length.cast(), size_of::<usize>());
    ask(
        context,
        Request::Property(
            ForeignText::new(name),
            ForeignBytesMut::new(value, capacity),
            length,
        ),
    )
}

unsafe extern "C" fn now_ns(context: *mut HostContext) -> u64 {
    ask_here(context, &Request::Now)
}

unsafe extern "C" fn log(context: *mut HostContext, level: u32, message: Text) -> Status {
    ask(context, Request::Log(level, ForeignText::new(message)))
}

unsafe extern "C" fn critical(
    context: *mut HostContext,
    address: *mut u8,
    length: usize,
) -> Status {
    ask(context, Request::Critical(address, length))
}

unsafe extern "C" fn report_fault(
    context: *mut HostContext,
    code: Status,
    message: Text,
) -> Status {
    ask(
        context,
        Request::ReportFault(code, ForeignText::new(message)),
    )
}

unsafe extern "C" fn failed(
    context: *mut HostContext,
    message: Text,
    file: Text,
    line: u32,
    column: u32,
) -> Status {
    let (message, file) = (ForeignText::new(message), ForeignText::new(file));
    ask(context, Request::Failed(message, file, line, column))
}

unsafe extern "C" fn open_device(
    context: *mut HostContext,
    name: Text,
    descriptor: *mut i32,
) -> Status {
    let descriptor = ForeignBytesMut::new(descriptor.cast(), size_of::<i32>());
    ask(
        context,
        Request::OpenDevice(ForeignText::new(name), descriptor),
    )
}
