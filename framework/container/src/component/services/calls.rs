//! Service calls from one component to another, on the caller's thread.

use std::time::Duration;

use component_abi::Status;

use super::Services;
use crate::component::port_end::{BoundMethod, PortEnd, Provider};
use crate::guard::loss::DEEPEST_CALL_CHAIN;
use crate::guard::{ForeignBytes, ForeignBytesMut, Guarded, ServiceCall};
use crate::lane;
use crate::port::Sent;

/// How long a blocking call may wait if the caller names no deadline: longer than any sane
/// callback, short enough that a stuck callee is noticed by a person.
const DEFAULT_CALL_DEADLINE: Duration = Duration::from_secs(1);

impl Services {
    /// Calls a method of the service that is connected to a required port.
    pub(super) fn call(
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
