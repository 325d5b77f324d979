//! Ends of ports for leaves.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use fault_manager::detection::NumberReader;
use system_model::rules::SafeValue;
use system_model::specification::{ExecutionKind, QueuePolicy};

use super::{Misfit, Seat};
use crate::assembly::{EVENT_QUEUE, wake_of};
use crate::component::{Inbox, PortEnd, SafeDatum};
use crate::lane::SETUP_TOKEN;
use crate::mission::calls::Method;
use crate::mission::leaves::data::{Outlet, Watched, WritePort};
use crate::mission::leaves::messages::{RaiseEvent, WaitForEvent};
use crate::mission::leaves::service::CallService;
use crate::port::{Receiver, Sender, connection, mailbox};
use crate::wake::Wake;

impl Seat<'_> {
    /// A connection of its own to an output port; `reads`: the field that the node names.
    pub(super) fn watched(&self, component: usize, reads: bool) -> Result<Watched, Misfit> {
        let (index, port) = self.port(component)?;
        let data_type = self.data_type(port)?;
        let field = self.word("field");
        let reader = match (reads, &field) {
            (true, Some(field)) => Some(
                NumberReader::compile(data_type, Some(field), 0)
                    .map_err(|error| self.no_field(&error.to_string()))?,
            ),
            _ => None,
        };
        let (sender, receiver): (Sender, Receiver) =
            connection(QueuePolicy::Last, 1, data_type.size);
        self.with_end(component, index, |end| match end {
            PortEnd::DataOutput(output) => {
                output.connections.push((sender, None));
                Some(())
            }
            _ => None,
        })?;
        Ok(Watched::new(receiver, reader))
    }

    pub(super) fn written(&self, component: usize) -> Result<WritePort, Misfit> {
        let (index, port) = self.port(component)?;
        let data_type = self.data_type(port)?;
        let safe = SafeValue {
            field: self.word("field"),
            value: 0.0,
        };
        let datum = SafeDatum::new(data_type, [&safe])
            .map_err(|field| self.no_field(&format!("no field `{field}`")))?;
        Ok(WritePort {
            reach: Arc::clone(&self.ground.reach),
            outlet: self.outlet(component, index, data_type.size)?,
            datum,
        })
    }

    /// The way to an input port; all nodes that write there share it.
    fn outlet(
        &self,
        component: usize,
        port: usize,
        size: usize,
    ) -> Result<Arc<Mutex<Outlet>>, Misfit> {
        let mut outlets = self.ground.outlets.0.borrow_mut();
        if let Some(outlet) = outlets.get(&(component, port)) {
            return Ok(Arc::clone(outlet));
        }
        let (sender, receiver) = connection(QueuePolicy::Last, 1, size);
        self.with_end(component, port, |end| match end {
            PortEnd::DataInput(input) if input.source.is_none() => {
                input.source = Some(receiver);
                Some(())
            }
            _ => None,
        })?;
        let (wake, kind) = self.wake(component);
        let wake = (kind == ExecutionKind::Aperiodic).then_some(wake);
        let outlet = Arc::new(Mutex::new(Outlet::new(sender, size, wake)));
        outlets.insert((component, port), Arc::clone(&outlet));
        Ok(outlet)
    }

    pub(super) fn awaited_event(&self, component: usize) -> Result<WaitForEvent, Misfit> {
        let (index, port) = self.port(component)?;
        let size = port.data_type.as_ref().map_or(0, |it| it.size);
        let (sender, messages) = mailbox(EVENT_QUEUE, size);
        self.with_end(component, index, |end| match end {
            PortEnd::EventOutput(output) => {
                output.connections.push((sender, Arc::default()));
                Some(())
            }
            _ => None,
        })?;
        Ok(WaitForEvent::new(messages))
    }

    pub(super) fn raised_event(&self, component: usize) -> Result<RaiseEvent, Misfit> {
        let (index, port) = self.port(component)?;
        let size = port.data_type.as_ref().map_or(0, |it| it.size);
        let (sender, messages) = mailbox(EVENT_QUEUE, size);
        let cell = self.ground.assembly.components.get(component);
        if let Some(mut component) = cell.and_then(|it| it.enter(SETUP_TOKEN, Duration::ZERO)) {
            component.services_mut().add_inbox(Inbox {
                port: u32::try_from(index).unwrap_or(u32::MAX),
                method: None,
                messages,
                in_work: None,
                deaths: 0,
            });
        }
        let (wake, _) = self.wake(component);
        Ok(RaiseEvent {
            reach: Arc::clone(&self.ground.reach),
            sender,
            wake,
        })
    }

    pub(super) fn called(&self, component: usize) -> Result<CallService, Misfit> {
        let (port, description) = self.port(component)?;
        let name = self.word("method").unwrap_or_default();
        let mut methods = description.methods.iter().enumerate();
        let (number, method) = methods
            .find(|(_, method)| method.name == name)
            .ok_or_else(|| self.unknown("method", &name))?;
        let request = method.request.as_ref().map(|data_type| {
            // Without a field every number of the request has the value.
            let value = self.says("value").then(|| SafeValue {
                field: self.word("field"),
                value: 0.0,
            });
            SafeDatum::new(data_type, &value)
                .map_err(|field| self.no_field(&format!("no field `{field}`")))
        });
        let reply = match &method.reply {
            Some(data_type) if self.says("reply") => Some(
                NumberReader::compile(data_type, self.word("reply_field").as_deref(), 0)
                    .map_err(|error| self.no_field(&error.to_string()))?,
            ),
            _ => None,
        };
        let provider = self.ground.assembly.components.get(component);
        let provider = provider.ok_or_else(|| self.unknown("component", ""))?;
        provider.share();
        self.ground.calls.use_them();
        let index = |number| u32::try_from(number).unwrap_or(u32::MAX);
        Ok(CallService {
            reach: Arc::clone(&self.ground.reach),
            calls: Arc::clone(self.ground.calls),
            method: Method {
                provider: Arc::clone(provider),
                port: index(port),
                method: index(number),
                reply_size: method.reply.as_ref().map_or(0, |it| it.size),
            },
            request: request.transpose()?,
            reply,
            under_way: None,
            deadline: Duration::ZERO,
        })
    }

    /// What wakes a component's executor.
    fn wake(&self, component: usize) -> (Arc<Wake>, ExecutionKind) {
        let found = wake_of(&self.ground.assembly.executors, component);
        // Every component is in an executor.
        found.unwrap_or_else(|| (Arc::default(), ExecutionKind::Passive))
    }
}
