//! What a component may ask of the container, answered: ports, properties, log, clock, memory,
//! devices. Runs on the container's stack while the component is suspended.

use std::sync::Arc;
use std::time::Duration;

use component_abi::Status;
use system_model::fault::{Fault, FaultKind};

use super::cell::ComponentCell;
use crate::clock::Clock;
use crate::device::Devices;
use crate::event_log::{Event, EventLog};
use crate::guard::loss::DEEPEST_CALL_CHAIN;
use crate::guard::{
    ForeignBytes, ForeignBytesMut, ForeignText, Guarded, HostServices, Request, ServiceCall,
};
use crate::lane;
use crate::port::{Datum, MailReceiver, MailSender, Receiver, Sender, Sent};
use crate::wake::Wake;

/// How long a blocking call may wait if the caller names no deadline: longer than any sane
/// callback, short enough that a stuck callee is noticed by a person.
const DEFAULT_CALL_DEADLINE: Duration = Duration::from_secs(1);

/// What all components of an application share.
#[derive(Debug)]
pub struct Environment {
    /// The clock.
    pub clock: Clock,
    /// The event log.
    pub events: EventLog,
    /// Devices that can be opened.
    pub devices: Devices,
}

/// The container's end of a port, by the port's index.
pub enum PortEnd {
    /// Data input: what arrives, and the size of a datum.
    DataInput(Option<Receiver>, usize),
    /// Data output.
    DataOutput(DataOutput),
    /// Event input; its messages are in an [`Inbox`].
    EventInput,
    /// Event output.
    EventOutput(EventOutput),
    /// Required service.
    Required(Calls),
    /// Provided service; queued calls are in an [`Inbox`].
    Provided,
}

/// A data output with its connections.
pub struct DataOutput {
    /// Size of a datum.
    pub size: usize,
    /// One for each connected input, with what wakes its reader.
    pub connections: Vec<(Sender, Option<Arc<Wake>>)>,
}

/// An event output with its connections.
pub struct EventOutput {
    /// Size of the content.
    pub size: usize,
    /// One for each connected input, with what wakes its receiver.
    pub connections: Vec<(MailSender, Arc<Wake>)>,
}

/// Messages that arrive by one connection.
pub struct Inbox {
    /// The port they arrive at.
    pub port: u32,
    /// The method, for queued calls; `None` for events.
    pub method: Option<u32>,
    /// The queue.
    pub messages: MailReceiver,
}

/// A required service.
pub struct Calls {
    /// Its methods in the caller's order.
    pub methods: Vec<BoundMethod>,
    /// The provider, if one is connected.
    pub provider: Option<Provider>,
}

/// The component that provides a service.
pub struct Provider {
    /// The component.
    pub component: Arc<ComponentCell>,
    /// Index of its port.
    pub port: u32,
    /// What wakes it for queued calls.
    pub wake: Arc<Wake>,
}

/// A required method, bound to the provider's.
pub struct BoundMethod {
    /// Index in the provider's list.
    pub index: u32,
    /// Buffer for the request, of its exact size.
    pub request: Box<[u8]>,
    /// Buffer for the reply, of its exact size.
    pub reply: Box<[u8]>,
    /// The queue of a nonblocking method; `None` for a blocking one.
    pub queue: Option<MailSender>,
}

/// The services of one component instance.
pub struct Services {
    name: Arc<str>,
    incarnation: u32,
    environment: Arc<Environment>,
    ports: Vec<PortEnd>,
    inboxes: Vec<Inbox>,
    properties: Vec<(String, String)>,
    cycle_ns: u64,
    callback: &'static str,
    failure: Option<(String, String, u32, u32)>,
    last_status: Status,
    bad_pointer: Option<&'static str>,
    critical_bytes: Option<(usize, usize)>,
}

impl Services {
    /// Services with nothing connected.
    pub fn new(
        name: Arc<str>,
        incarnation: u32,
        environment: Arc<Environment>,
        ports: Vec<PortEnd>,
        properties: Vec<(String, String)>,
    ) -> Self {
        Self {
            name,
            incarnation,
            environment,
            ports,
            inboxes: Vec::new(),
            properties,
            cycle_ns: 0,
            callback: "",
            failure: None,
            last_status: Status::SUCCESS,
            bad_pointer: None,
            critical_bytes: None,
        }
    }

    /// Instance name.
    pub fn name(&self) -> &Arc<str> {
        &self.name
    }

    /// The container's end of a port.
    pub fn port_mut(&mut self, index: usize) -> Option<&mut PortEnd> {
        self.ports.get_mut(index)
    }

    /// Adds a queue of messages for this component.
    pub fn add_inbox(&mut self, inbox: Inbox) {
        self.inboxes.push(inbox);
    }

    pub(super) fn inboxes(&self) -> usize {
        self.inboxes.len()
    }

    pub(super) fn take_message(&mut self, inbox: usize) -> Option<(u32, Option<u32>, Datum)> {
        let inbox = self.inboxes.get_mut(inbox)?;
        let message = inbox.messages.take()?;
        Some((inbox.port, inbox.method, message))
    }

    pub(super) fn give_back(&mut self, inbox: usize, message: Datum) {
        if let Some(inbox) = self.inboxes.get_mut(inbox) {
            inbox.messages.give_back(message);
        }
    }

    /// Forgets all data and events that have arrived (onStop).
    pub(super) fn clear_inputs(&mut self) {
        for port in &mut self.ports {
            if let PortEnd::DataInput(Some(receiver), _) = port {
                receiver.clear();
            }
        }
        for inbox in &mut self.inboxes {
            inbox.messages.clear();
        }
    }

    pub(super) fn set_cycle_time(&mut self, now_ns: u64) {
        self.cycle_ns = now_ns;
    }

    pub(super) fn set_callback(&mut self, name: &'static str) {
        self.callback = name;
    }

    /// The callback that is under way, or was the last.
    pub(super) fn callback(&self) -> &'static str {
        self.callback
    }

    pub(super) fn has_bad_pointer(&self) -> bool {
        self.bad_pointer.is_some()
    }

    pub(super) fn last_status(&self) -> Status {
        self.last_status
    }

    pub(super) fn record(&self, event: Event) {
        self.environment
            .events
            .record(self.environment.clock.now_ns(), event);
    }

    /// The fault behind a callback that returned: a failure, a panic, or a success in which the
    /// component passed memory that is not accessible.
    pub(super) fn returned_fault(&mut self, status: Status, callback: &'static str) -> Fault {
        self.last_status = status;
        if let Some(service) = self.bad_pointer.take() {
            return Fault {
                kind: FaultKind::BadPointer,
                callback,
                message: format!("it passed memory to '{service}' that is not accessible"),
                place: None,
                thread_lost: false,
            };
        }
        let (message, file, line, column) = self.failure.take().unwrap_or_default();
        let panicked = status == Status::PANICKED;
        Fault {
            kind: if panicked {
                FaultKind::Panic
            } else {
                FaultKind::ErrorReturn
            },
            callback,
            message: match (panicked, message.is_empty()) {
                (true, _) => message,
                (false, true) => format!("it returned {status}"),
                (false, false) => format!("{message} ({status})"),
            },
            place: (line > 0).then_some((file, line, column)),
            thread_lost: false,
        }
    }

    fn bad_pointer(&mut self, service: &'static str) -> Status {
        self.bad_pointer = Some(service);
        Status::BAD_INPUT_PARAMETER
    }

    fn text(&mut self, text: ForeignText, service: &'static str) -> Result<String, Status> {
        text.read().ok_or_else(|| self.bad_pointer(service))
    }

    #[inline]
    fn read(&mut self, port: u32, data: ForeignBytesMut) -> Status {
        let Some(PortEnd::DataInput(receiver, size)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        if data.size() != *size {
            return Status::BAD_INPUT_PARAMETER;
        }
        match receiver.as_mut().and_then(Receiver::receive) {
            None => Status::NOTHING,
            Some(datum) if data.copy_from(&datum.bytes) => Status::SUCCESS,
            Some(_) => self.bad_pointer("read"),
        }
    }

    #[inline]
    fn write(&mut self, port: u32, data: ForeignBytes) -> Status {
        let Some(PortEnd::DataOutput(output)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        if data.size() != output.size {
            return Status::BAD_INPUT_PARAMETER;
        }
        for (sender, wake) in &mut output.connections {
            if !sender.send(self.cycle_ns, self.incarnation, |bytes| data.copy_to(bytes)) {
                return self.bad_pointer("write");
            }
            if let Some(wake) = wake {
                wake.wake();
            }
        }
        Status::SUCCESS
    }

    fn raise(&mut self, port: u32, data: ForeignBytes) -> Status {
        let Some(PortEnd::EventOutput(output)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        if data.size() != output.size {
            return Status::BAD_INPUT_PARAMETER;
        }
        let mut answer = Status::SUCCESS;
        for (sender, wake) in &mut output.connections {
            match sender.send(self.cycle_ns, self.incarnation, |bytes| data.copy_to(bytes)) {
                Sent::Queued => wake.wake(),
                Sent::Full => answer = Status::OUT_OF_RESOURCES,
                Sent::Unreadable => return self.bad_pointer("raise"),
            }
        }
        answer
    }

    fn call(
        &mut self,
        port: u32,
        method: u32,
        request: ForeignBytes,
        reply: ForeignBytesMut,
        deadline_ns: u64,
    ) -> Status {
        let Some(PortEnd::Required(calls)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        let Some(provider) = &calls.provider else {
            return Status::PRECONDITION_NOT_MET;
        };
        let Some(method) = calls.methods.get_mut(method as usize) else {
            return Status::UNSUPPORTED_METHOD;
        };
        if request.size() != method.request.len() || reply.size() != method.reply.len() {
            return Status::BAD_INPUT_PARAMETER;
        }
        if let Some(queue) = &mut method.queue {
            let sent = queue.send(self.cycle_ns, self.incarnation, |bytes| {
                request.copy_to(bytes)
            });
            return match sent {
                Sent::Queued => {
                    provider.wake.wake();
                    Status::SUCCESS
                }
                Sent::Full => Status::OUT_OF_RESOURCES,
                Sent::Unreadable => self.bad_pointer("call"),
            };
        }
        if !request.copy_to(&mut method.request) {
            return self.bad_pointer("call");
        }
        let now_ns = self.environment.clock.now_ns();
        let status = call_provider(provider, method, deadline_ns, now_ns);
        if status.is_success() && !reply.copy_from(&method.reply) {
            return self.bad_pointer("call");
        }
        status
    }

    fn property(
        &mut self,
        name: ForeignText,
        value: ForeignBytesMut,
        length: ForeignBytesMut,
    ) -> Result<Status, Status> {
        let name = self.text(name, "property")?;
        // The subcomponent's own values stand last and win.
        let found = self.properties.iter().rev().find(|(key, _)| *key == name);
        let Some((_, text)) = found else {
            return Ok(Status::NOTHING);
        };
        let bytes = text.as_bytes();
        if !length.copy_from(&bytes.len().to_ne_bytes()) {
            return Err(self.bad_pointer("property"));
        }
        if bytes.len() > value.size() {
            return Ok(Status::OUT_OF_RESOURCES);
        }
        if value.copy_from(bytes) {
            Ok(Status::SUCCESS)
        } else {
            Err(self.bad_pointer("property"))
        }
    }

    fn log(&mut self, level: u32, message: ForeignText) -> Result<Status, Status> {
        let message = self.text(message, "log")?;
        let level = match level {
            1 => "error",
            2 => "warning",
            3 => "information",
            _ => "debug",
        };
        self.record(Event::Log {
            component: self.name.to_string(),
            level,
            message,
        });
        Ok(Status::SUCCESS)
    }

    fn report_fault(&mut self, code: Status, message: ForeignText) -> Result<Status, Status> {
        let message = self.text(message, "report_fault")?;
        let fault = Fault {
            kind: FaultKind::Reported,
            callback: self.callback,
            message: format!("{message} ({code})"),
            place: None,
            thread_lost: false,
        };
        self.record(Event::fault(&self.name, self.incarnation, &fault));
        Ok(Status::SUCCESS)
    }

    fn failed(
        &mut self,
        message: ForeignText,
        file: ForeignText,
        line: u32,
        column: u32,
    ) -> Result<Status, Status> {
        let message = self.text(message, "failed")?;
        let file = self.text(file, "failed")?;
        self.failure = Some((message, file, line, column));
        Ok(Status::SUCCESS)
    }

    fn open_device(
        &mut self,
        name: ForeignText,
        descriptor: ForeignBytesMut,
    ) -> Result<Status, Status> {
        let name = self.text(name, "open_device")?;
        match self.environment.devices.open(&name) {
            Ok(device) => {
                let number = device.number();
                if descriptor.copy_from(&number.to_ne_bytes()) {
                    device.give_away();
                    Ok(Status::SUCCESS)
                } else {
                    Err(self.bad_pointer("open_device"))
                }
            }
            Err(error) => {
                self.record(Event::Log {
                    component: self.name.to_string(),
                    level: "error",
                    message: error.to_string(),
                });
                Ok(Status::CALLEE_ERROR)
            }
        }
    }
}

impl HostServices for Services {
    #[inline]
    fn answer(&mut self, request: &Request) -> u64 {
        let status = match request {
            Request::Read(port, data) => self.read(*port, *data),
            Request::Write(port, data) => self.write(*port, *data),
            Request::Now => return self.environment.clock.now_ns(),
            other => self.answer_rarely(*other),
        };
        u64::from(status.0)
    }
}

impl Services {
    /// Everything that is not asked every cycle.
    #[cold]
    fn answer_rarely(&mut self, request: Request) -> Status {
        let result = match request {
            Request::Raise(port, data) => Ok(self.raise(port, data)),
            Request::Call(port, method, request, reply, deadline_ns) => {
                Ok(self.call(port, method, request, reply, deadline_ns))
            }
            Request::Property(name, value, length) => self.property(name, value, length),
            Request::Log(level, message) => self.log(level, message),
            Request::Critical(address, length) => {
                self.critical_bytes = (length > 0).then_some((address.addr(), length));
                Ok(Status::SUCCESS)
            }
            Request::ReportFault(code, message) => self.report_fault(code, message),
            Request::Failed(message, file, line, column) => {
                self.failed(message, file, line, column)
            }
            Request::OpenDevice(name, descriptor) => self.open_device(name, descriptor),
            Request::Read(..) | Request::Write(..) | Request::Now => Ok(Status::UNSUPPORTED_METHOD),
        };
        result.unwrap_or_else(|status| status)
    }

    /// Address and length of the registered critical memory.
    pub fn critical(&self) -> Option<(usize, usize)> {
        self.critical_bytes
    }
}

/// Calls the provider on this thread, if it is free before the deadline.
fn call_provider(
    provider: &Provider,
    method: &mut BoundMethod,
    deadline_ns: u64,
    now_ns: u64,
) -> Status {
    let limit = match deadline_ns {
        0 => DEFAULT_CALL_DEADLINE,
        deadline_ns => Duration::from_nanos(deadline_ns),
    };
    if Guarded::call_depth() >= DEEPEST_CALL_CHAIN {
        return Status::OUT_OF_RESOURCES;
    }
    let Some(lane) = lane::current() else {
        return Status::UNAUTHORIZED;
    };
    let Some(mut callee) = provider.component.enter(lane.token(), limit) else {
        return Status::TIMED_OUT;
    };
    let call = ServiceCall {
        port: provider.port,
        method: method.index,
        request: method.request.as_ptr(),
        request_size: method.request.len(),
        reply: method.reply.as_mut_ptr(),
        reply_size: method.reply.len(),
    };
    callee.serve(call, now_ns, lane.loss())
}
