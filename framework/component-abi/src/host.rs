//! What a component may ask of the container.

use crate::descriptor::Header;
use crate::status::Status;
use crate::text::Text;

/// Names one component instance in host calls; its inside belongs to the container.
#[repr(C)]
pub struct HostContext {
    _opaque: [u8; 0],
}

/// How important a log line is.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// Something failed.
    Error = 1,
    /// Something looks wrong.
    Warning = 2,
    /// Worth knowing.
    Information = 3,
    /// For the author.
    Debug = 4,
}

/// Host services. Each may be called only from inside a callback, on the thread and stack that
/// the callback was called on; from anywhere else it answers [`Status::UNAUTHORIZED`].
#[repr(C)]
#[derive(Clone, Copy)]
pub struct HostTable {
    /// Version and size of this table.
    pub header: Header,
    /// Copies the next datum of data input `port` into `data` (`size` bytes, the size of its
    /// type): SUCCESS for a new datum, NOTHING if there is none since the last read.
    pub read:
        unsafe extern "C" fn(*mut HostContext, port: u32, data: *mut u8, size: usize) -> Status,
    /// Sends a datum through data output `port`. Success also when nothing is connected.
    pub write:
        unsafe extern "C" fn(*mut HostContext, port: u32, data: *const u8, size: usize) -> Status,
    /// Sends an event through event output `port`; OUT_OF_RESOURCES if a receiver's queue is full.
    pub raise:
        unsafe extern "C" fn(*mut HostContext, port: u32, data: *const u8, size: usize) -> Status,
    /// Calls `method` of required service `port`. A nonblocking method returns at once and has no
    /// reply; a blocking one waits at most `deadline_ns` (0: the container's default).
    pub call: unsafe extern "C" fn(
        *mut HostContext,
        port: u32,
        method: u32,
        request: *const u8,
        request_size: usize,
        reply: *mut u8,
        reply_size: usize,
        deadline_ns: u64,
    ) -> Status,
    /// Copies the property `name` into `value` (at most `capacity` bytes) and stores its full
    /// length in bytes; NOTHING if it is not set, OUT_OF_RESOURCES if `capacity` was too small.
    pub property: unsafe extern "C" fn(
        *mut HostContext,
        name: Text,
        value: *mut u8,
        capacity: usize,
        length: *mut usize,
    ) -> Status,
    /// Time of the container's clock in nanoseconds since the application started; 0 outside a
    /// callback. Simulated time when the container runs simulated.
    pub now_ns: unsafe extern "C" fn(*mut HostContext) -> u64,
    /// Writes a log line; `level` is a [`LogLevel`] as a number.
    pub log: unsafe extern "C" fn(*mut HostContext, level: u32, message: Text) -> Status,
    /// Registers the consecutive memory that holds the component's state (paper, section 3.4.1).
    /// It must stay valid until the instance is destroyed. One region an instance; length 0
    /// withdraws it.
    pub critical: unsafe extern "C" fn(*mut HostContext, address: *mut u8, length: usize) -> Status,
    /// Reports a fault that the component has found itself.
    pub report_fault: unsafe extern "C" fn(*mut HostContext, code: Status, message: Text) -> Status,
    /// Says why this callback is about to return a failure, or [`Status::PANICKED`]: text and, where
    /// known, place in the component's source (empty file and line 0 otherwise).
    pub failed: unsafe extern "C" fn(
        *mut HostContext,
        message: Text,
        file: Text,
        line: u32,
        column: u32,
    ) -> Status,
    /// Opens a device: a name of the simulated world (`simulated:motion_board`) or a path
    /// (`/dev/ttyUSB0`, a terminal is set to raw 115200 8N1). Non-blocking; the descriptor belongs
    /// to the component.
    pub open_device:
        unsafe extern "C" fn(*mut HostContext, name: Text, descriptor: *mut i32) -> Status,
}
