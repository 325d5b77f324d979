//! The container as a component sees it: properties, log, clock, registered memory, devices.
#![allow(unsafe_code)] // every call through the host table is a foreign call

use std::fmt;
use std::fs::File;
use std::os::fd::{FromRawFd, OwnedFd};
use std::str::FromStr;
use std::time::Duration;

use component_abi::{HostContext, HostTable, LogLevel, Status, Text};

use crate::component::Failure;
use crate::data::{EventContent, PortData};

/// Longest property value that is read, in bytes: properties are settings, not documents.
const LONGEST_PROPERTY: usize = 4096;

/// Handle to the container, for one component instance. Only valid inside callbacks; the
/// container refuses calls from other threads.
#[derive(Clone, Copy)]
pub struct Host {
    table: *const HostTable,
    context: *mut HostContext,
}

/// The container as a component sees it inside a callback.
pub struct Context {
    host: Host,
}

impl Context {
    /// The property `name` as text, if the profile or the application sets it.
    pub fn property(&self, name: &str) -> Option<String> {
        self.host.property(name)
    }

    /// The property `name`, parsed; `default` if it is not set.
    ///
    /// # Errors
    /// INPUT_OUT_OF_RANGE if it is set but does not parse as `T`.
    pub fn property_or<T: FromStr>(&self, name: &str, default: T) -> Result<T, Failure>
    where
        T::Err: fmt::Display,
    {
        let Some(text) = self.property(name) else {
            return Ok(default);
        };
        text.trim().parse().map_err(|error| {
            Failure::new(
                Status::INPUT_OUT_OF_RANGE,
                format!("property '{name}' is '{text}': {error}"),
            )
        })
    }

    /// Time since the application started, by the container's clock (simulated or real).
    pub fn now(&self) -> Duration {
        Duration::from_nanos(self.host.now_ns())
    }

    /// Logs an error.
    pub fn error(&self, message: impl AsRef<str>) {
        self.host.log(LogLevel::Error, message.as_ref());
    }

    /// Logs a warning.
    pub fn warn(&self, message: impl AsRef<str>) {
        self.host.log(LogLevel::Warning, message.as_ref());
    }

    /// Logs something worth knowing.
    pub fn info(&self, message: impl AsRef<str>) {
        self.host.log(LogLevel::Information, message.as_ref());
    }

    /// Logs for the author.
    pub fn debug(&self, message: impl AsRef<str>) {
        self.host.log(LogLevel::Debug, message.as_ref());
    }

    /// Registers `state` as the component's critical memory (paper, section 3.4.1: `critical(addr,
    /// len)`): the container may copy it out between callbacks and copy it back before
    /// `on_recover`. The state is leaked into memory that lives as long as the instance, so it is
    /// handed back as a mutable borrow to keep.
    ///
    /// # Errors
    /// The container's answer if it refuses.
    pub fn critical<T: PortData>(&self, state: T) -> Result<&'static mut T, Failure> {
        let memory: &'static mut T = Box::leak(Box::new(state));
        let status = self
            .host
            .critical(std::ptr::from_mut(memory).cast(), size_of::<T>());
        if status.is_success() {
            Ok(memory)
        } else {
            Err(Failure::new(status, "critical memory was not registered"))
        }
    }

    /// Reports a fault that the component itself has found.
    pub fn report_fault(&self, code: Status, message: impl AsRef<str>) {
        self.host.report_fault(code, message.as_ref());
    }

    /// Opens a device of the simulated world (`simulated:motion_board`) or of the machine
    /// (`/dev/ttyUSB0`; terminals are set to raw 115200 8N1). Reads and writes do not block.
    ///
    /// # Errors
    /// If there is no such device or it cannot be opened; the container logs why.
    pub fn open_device(&self, name: &str) -> Result<File, Failure> {
        self.host.open_device(name)
    }
}

#[doc(hidden)]
impl Host {
    pub(crate) fn new(table: *const HostTable, context: *mut HostContext) -> Self {
        Self { table, context }
    }

    pub(crate) fn context(self) -> Context {
        Context { host: self }
    }

    fn table(&self) -> &HostTable {
        // SAFETY: the container keeps the table for as long as the instance lives, and a host
        // handle is reachable only from the instance.
        unsafe { &*self.table }
    }

    pub(crate) fn read<T: PortData>(self, port: u32) -> Option<T> {
        let mut datum = std::mem::MaybeUninit::<T>::uninit();
        // SAFETY: `datum` is writable for the size of `T`.
        let status = unsafe {
            (self.table().read)(
                self.context,
                port,
                datum.as_mut_ptr().cast(),
                size_of::<T>(),
            )
        };
        // SAFETY: on success the container has filled all bytes, and every bit pattern is a valid
        // `T` (contract of `PortData`).
        status.is_success().then(|| unsafe { datum.assume_init() })
    }

    pub(crate) fn write<T: PortData>(self, port: u32, datum: &T) -> Status {
        // SAFETY: `datum` is readable for the size of `T`.
        unsafe {
            (self.table().write)(
                self.context,
                port,
                std::ptr::from_ref(datum).cast(),
                size_of::<T>(),
            )
        }
    }

    pub(crate) fn raise<T: EventContent>(self, port: u32, datum: &T) -> Status {
        // SAFETY: `datum` is readable for the size of `T`.
        unsafe {
            (self.table().raise)(
                self.context,
                port,
                std::ptr::from_ref(datum).cast(),
                size_of::<T>(),
            )
        }
    }

    pub(crate) fn call<Request: PortData, Reply: PortData>(
        self,
        port: u32,
        method: u32,
        request: &Request,
        deadline: Duration,
    ) -> Result<Reply, Status> {
        let deadline_ns = u64::try_from(deadline.as_nanos()).unwrap_or(u64::MAX);
        let mut reply = std::mem::MaybeUninit::<Reply>::zeroed();
        // SAFETY: request and reply are readable, respectively writable, for their sizes.
        let status = unsafe {
            (self.table().call)(
                self.context,
                port,
                method,
                std::ptr::from_ref(request).cast(),
                size_of::<Request>(),
                reply.as_mut_ptr().cast(),
                size_of::<Reply>(),
                deadline_ns,
            )
        };
        if status.is_success() {
            // SAFETY: the memory is zeroed or filled by the callee, and every bit pattern is a
            // valid `Reply` (contract of `PortData`).
            Ok(unsafe { reply.assume_init() })
        } else {
            Err(status)
        }
    }

    pub(crate) fn send<Request: PortData>(
        self,
        port: u32,
        method: u32,
        request: &Request,
    ) -> Status {
        // SAFETY: the request is readable for its size; there is no reply.
        unsafe {
            (self.table().call)(
                self.context,
                port,
                method,
                std::ptr::from_ref(request).cast(),
                size_of::<Request>(),
                std::ptr::null_mut(),
                0,
                0,
            )
        }
    }

    pub(crate) fn failed(self, message: &str, file: &str, line: u32, column: u32) {
        // SAFETY: the texts outlive the call.
        let _ = unsafe {
            (self.table().failed)(
                self.context,
                Text::new(message),
                Text::new(file),
                line,
                column,
            )
        };
    }

    fn property(&self, name: &str) -> Option<String> {
        let mut value = vec![0u8; LONGEST_PROPERTY];
        let mut length = 0;
        // SAFETY: `value` is writable for its length, `length` is a place for one number.
        let status = unsafe {
            (self.table().property)(
                self.context,
                Text::new(name),
                value.as_mut_ptr(),
                value.len(),
                &raw mut length,
            )
        };
        if !status.is_success() {
            return None;
        }
        value.truncate(length);
        String::from_utf8(value).ok()
    }

    fn now_ns(&self) -> u64 {
        // SAFETY: no pointers but the context, which the container handed out.
        unsafe { (self.table().now_ns)(self.context) }
    }

    fn log(&self, level: LogLevel, message: &str) {
        // SAFETY: the text outlives the call.
        let _ = unsafe { (self.table().log)(self.context, level as u32, Text::new(message)) };
    }

    fn critical(&self, address: *mut u8, length: usize) -> Status {
        // SAFETY: `Context::critical` passes leaked memory of this length.
        unsafe { (self.table().critical)(self.context, address, length) }
    }

    fn report_fault(&self, code: Status, message: &str) {
        // SAFETY: the text outlives the call.
        let _ = unsafe { (self.table().report_fault)(self.context, code, Text::new(message)) };
    }

    fn open_device(&self, name: &str) -> Result<File, Failure> {
        let mut descriptor = -1;
        // SAFETY: the text outlives the call, `descriptor` is a place for one number.
        let status = unsafe {
            (self.table().open_device)(self.context, Text::new(name), &raw mut descriptor)
        };
        if !status.is_success() || descriptor < 0 {
            return Err(Failure::new(
                status,
                format!("device '{name}' does not open"),
            ));
        }
        // SAFETY: on success the container has given this descriptor away.
        Ok(File::from(unsafe { OwnedFd::from_raw_fd(descriptor) }))
    }
}
