//! What others ask of a component: events, queued calls, calls on their own thread.

use component_abi::Status;
use system_model::fault::FaultKind;
use system_model::life_cycle::LifeCycleState;
use system_model::specification::{PortDirection, PortKind};

use super::Component;
use crate::guard::loss::Loss;
use crate::guard::{Callback, ServiceCall};

/// The event port by which a component may hear of an emergency stop.
const EMERGENCY_STOP: &str = "emergency_stop";

impl Component {
    /// Delivers events and queued calls that have arrived. To a component that is not active
    /// nothing is delivered: what arrives meanwhile is thrown away.
    pub fn deliver(&mut self, now_ns: u64, loss: &Loss) {
        self.services.begin_cycle(now_ns);
        self.look_for_stray_fault();
        for inbox in 0..self.services.inboxes() {
            while let Some((port, method, data, size)) = self.services.take_message(inbox) {
                if !self.is_active() {
                    // One that is being recovered will want the message that was in work.
                    if self.services.has_leftover(inbox) {
                        break;
                    }
                    self.services.message_done(inbox);
                    continue;
                }
                let port = self.numbering.port(port);
                let (callback, name) = match method {
                    None => (Callback::Event(port, data, size), "onEvent"),
                    Some(method) => (
                        Callback::Call(ServiceCall {
                            port,
                            method: self.numbering.method(port, method),
                            request: data,
                            request_size: size,
                            reply: std::ptr::null_mut(),
                            reply_size: 0,
                        }),
                        "onCall",
                    ),
                };
                if self.run_or_fail(callback, name, loss).is_err() && !self.is_active() {
                    // What else has arrived is for the one that takes its place.
                    return;
                }
                self.services.message_done(inbox);
            }
        }
    }

    /// Serves a blocking call of another component, on that component's thread.
    pub fn serve(&mut self, call: ServiceCall, now_ns: u64, loss: &Loss) -> Status {
        if !self.is_active() {
            return Status::PRECONDITION_NOT_MET;
        }
        self.services.begin_cycle(now_ns);
        let port = self.numbering.port(call.port);
        let call = ServiceCall {
            port,
            method: self.numbering.method(port, call.method),
            ..call
        };
        match self.run(Callback::Call(call), "onCall", loss) {
            Ok(()) => Status::SUCCESS,
            // The callee said no. That is on record, but the callee goes on.
            Err(fault) if fault.kind == FaultKind::ErrorReturn => self.services.last_status(),
            Err(fault) => {
                self.enter_state(LifeCycleState::Error);
                self.report(&fault);
                Status::INTERNAL_FAULT
            }
        }
    }

    /// Raises the event `emergency_stop` in a component that has a port of this name for it.
    pub fn tell_emergency_stop(&mut self, loss: &Loss) {
        let port = self.services.interface().iter().position(|port| {
            (port.kind, port.direction, port.name.as_str())
                == (PortKind::Event, PortDirection::Input, EMERGENCY_STOP)
                && port.data_type.is_none()
        });
        if let Some(port) = port.and_then(|port| u32::try_from(port).ok()) {
            let event = Callback::Event(port, std::ptr::null(), 0);
            let _recorded = self.run_or_fail(event, "onEvent", loss);
        }
    }
}
