//! What a component may ask of the container, answered: ports, properties, log, clock, memory,
//! devices. `guard::host` says on which stack.

mod calls;
mod identity;
mod requests;
mod tapped;
mod work;

use std::sync::Arc;

use component_abi::Status;
use system_model::fault::{Fault, FaultKind};

use super::port_end::{Inbox, PortEnd};
use crate::adaptation::AdaptationRequests;
use crate::clock::Clock;
use crate::event_log::EventLog;
use crate::guard::{ForeignBytes, ForeignBytesMut, ForeignText, HostServices, Request};
use crate::injection::Injections;
use crate::library::PortDescription;
use crate::port::{Receiver, Sent};
use crate::replay::Score;
use crate::schedule::BusyTime;
use crate::supervision::{Observations, Scenes};
use crate::world::{World, Worlds};
use fault_manager::DetectorId;

/// What all components of an application share.
#[derive(Debug)]
pub struct Environment {
    /// The clock.
    pub clock: Clock,
    /// The event log.
    pub events: EventLog,
    /// What waits for the fault manager.
    pub observations: Observations,
    /// Where components were when they were taken off.
    pub scenes: Scenes,
    /// Faults that are made on purpose.
    pub injections: Injections,
    /// The simulated worlds, with the devices that can be opened there.
    pub worlds: Worlds,
    /// The recording that is played instead of components, if one is.
    pub score: Option<Arc<Score>>,
    /// Components without which a task is to go on.
    pub adaptation_requests: AdaptationRequests,
    /// For how long a component keeps its executor busy, in simulated time.
    pub busy: BusyTime,
}

/// The detectors of one component that the container itself serves.
#[derive(Debug, Clone, Copy)]
pub struct Detectors {
    /// The component's index.
    pub component: usize,
    /// Runtime exceptions.
    pub exception: DetectorId,
    /// Hangs.
    pub hang: DetectorId,
    /// What it reports itself.
    pub reported: DetectorId,
}

/// The services of one component instance.
pub struct Services {
    name: Arc<str>,
    /// The simulated world in which it opens devices.
    world: Option<Arc<World>>,
    incarnation: u32,
    environment: Arc<Environment>,
    /// Its ports, as its library describes them.
    interface: Arc<[PortDescription]>,
    ports: Vec<PortEnd>,
    inboxes: Vec<Inbox>,
    properties: Vec<(String, String)>,
    cycle_ns: u64,
    callback: &'static str,
    /// What was said during this callback of why it fails; boxed, because it is rare.
    explanation: Option<Box<Explanation>>,
    last_status: Status,
    bad_pointer: Option<&'static str>,
    /// Address and length of the memory that it registered.
    critical: Option<(usize, usize)>,
    /// None without a fault manager.
    detectors: Option<Detectors>,
    /// Faults that it may report by name, by rule.
    named_faults: Vec<(String, DetectorId)>,
    /// Inputs of which a datum is in work in this cycle, by bits.
    in_work: u64,
    /// An output of this cycle failed its check.
    contaminated: bool,
}

/// Why a callback fails.
#[derive(Debug, Default)]
struct Explanation {
    /// The component's words.
    message: String,
    /// File, line and column in its source.
    place: Option<(String, u32, u32)>,
    /// Why a device did not open.
    device: Option<String>,
}

impl Services {
    /// Services with nothing connected.
    pub fn new(
        name: Arc<str>,
        incarnation: u32,
        environment: Arc<Environment>,
        interface: Arc<[PortDescription]>,
        ports: Vec<PortEnd>,
        properties: Vec<(String, String)>,
    ) -> Self {
        Self {
            name,
            world: None,
            incarnation,
            environment,
            interface,
            ports,
            inboxes: Vec::new(),
            properties,
            cycle_ns: 0,
            callback: "",
            explanation: None,
            last_status: Status::SUCCESS,
            bad_pointer: None,
            critical: None,
            detectors: None,
            named_faults: Vec::new(),
            in_work: 0,
            contaminated: false,
        }
    }

    pub(super) fn begin(&mut self, callback: &'static str) {
        self.callback = callback;
        self.explanation = None;
    }

    /// The callback that is under way, or was the last.
    pub(super) fn callback(&self) -> &'static str {
        self.callback
    }

    pub(super) fn has_bad_pointer(&self) -> bool {
        self.bad_pointer.is_some()
    }

    /// The fault behind a callback that returned: a failure, a panic, or a success in which the
    /// component passed memory that is not accessible.
    pub(super) fn returned_fault(&mut self, status: Status, callback: &'static str) -> Fault {
        self.last_status = status;
        if let Some(service) = self.bad_pointer.take() {
            return Fault::new(
                FaultKind::BadPointer,
                callback,
                format!("it passed memory to '{service}' that is not accessible"),
            );
        }
        let explanation = self.explanation.take().unwrap_or_default();
        let panicked = status == Status::PANICKED;
        let message = explanation.message;
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
                (false, false) => match explanation.device {
                    Some(device) => format!("{message} ({status}): {device}"),
                    None => format!("{message} ({status})"),
                },
            },
            place: explanation.place,
            thread_lost: false,
            return_code: if panicked { 0 } else { status.0 },
            lasted: std::time::Duration::ZERO,
            signal: None,
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
        let Some(PortEnd::DataInput(input)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        if data.size() != input.size {
            let expected = input.size;
            return self.wrong_size(port, data.size(), expected);
        }
        if input.tap.is_some() {
            return self.read_tapped(port, data);
        }
        match input.source.as_mut().and_then(Receiver::receive) {
            None => Status::NOTHING,
            Some(datum) if data.copy_from(datum.bytes()) => {
                self.in_work |= bit(port);
                Status::SUCCESS
            }
            Some(_) => self.bad_pointer("read"),
        }
    }

    #[inline]
    fn write(&mut self, port: u32, data: ForeignBytes) -> Status {
        let Some(PortEnd::DataOutput(output)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        if data.size() != output.size {
            let expected = output.size;
            return self.wrong_size(port, data.size(), expected);
        }
        if output.tap.is_some() {
            return self.write_tapped(port, data);
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
            let expected = output.size;
            return self.wrong_size(port, data.size(), expected);
        }
        let mut answer = Status::SUCCESS;
        let fault = output.fault;
        if let Some(recorder) = &mut output.recorder {
            if !data.copy_to(&mut recorder.scratch) {
                return self.bad_pointer("raise");
            }
            let seen_ns = self.environment.clock.cycle_time_ns(self.cycle_ns);
            recorder
                .port
                .record(seen_ns, self.cycle_ns, &recorder.scratch);
        }
        for (sender, wake) in &mut output.connections {
            match sender.send(self.cycle_ns, self.incarnation, |bytes| data.copy_to(bytes)) {
                Sent::Queued => wake.wake(),
                Sent::Full => answer = Status::OUT_OF_RESOURCES,
                Sent::Unreadable => return self.bad_pointer("raise"),
            }
        }
        if let Some(detector) = fault {
            let name = self.port_name(port as usize);
            self.report_symptom(detector, format!("event '{name}'"), 0);
        }
        answer
    }
}

impl HostServices for Services {
    fn has_queue(&self, port: u32) -> bool {
        let Some(PortEnd::DataInput(input)) = self.ports.get(port as usize) else {
            return false;
        };
        input.source.as_ref().is_some_and(Receiver::has_queue)
    }

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
                self.critical = (length > 0).then(|| (address.expose_provenance(), length));
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
}

/// The bit of a port. What is in work on ports behind the 64th is not given to a successor.
fn bit(port: u32) -> u64 {
    1u64.checked_shl(port).unwrap_or(0)
}
