//! Connections, made.

use std::sync::Arc;

use system_model::data_type::DataType;
use system_model::specification::{
    ApplicationSpecification, ConnectionSpecification, ExecutionKind, PortKind, PortReference,
    QueuePolicy,
};

use super::compare::{port_of, provided_method};
use crate::component::{BoundMethod, ComponentCell, Inbox, PortEnd, Provider};
use crate::executor::Executor;
use crate::lane::SETUP_TOKEN;
use crate::library::LoadedLibrary;
use crate::port::{Drops, connection, mailbox};
use crate::wake::Wake;

/// Events that may wait for one receiver from one sender: two seconds of a sender that raises one
/// in every cycle of 30 ms.
pub(crate) const EVENT_QUEUE: usize = 64;

/// Nonblocking calls that may wait for one provider from one caller.
const CALL_QUEUE: usize = 16;

/// A connection of data ports, to be looked at.
#[derive(Debug, Clone)]
pub struct Link {
    /// The output.
    pub source: PortReference,
    /// The input.
    pub target: PortReference,
    /// Data that were dropped on the way.
    pub drops: Drops,
}

/// Makes all connections; those of data. They have been checked, so nothing is left out silently.
pub(super) fn connect(
    specification: &ApplicationSpecification,
    libraries: &[LoadedLibrary],
    components: &[Arc<ComponentCell>],
    executors: &[Executor],
) -> Vec<Link> {
    let mut links = Vec::new();
    for connection in &specification.connections {
        let wire = Wire {
            specification,
            libraries,
            components,
            connection,
            wake: wake_of(executors, connection.target.component),
        };
        match connection.kind {
            PortKind::Data => links.push(Link {
                source: connection.source.clone(),
                target: connection.target.clone(),
                drops: wire.data(),
            }),
            PortKind::Event => wire.event(),
            PortKind::Service => wire.service(),
        }
    }
    links
}

/// Tells every component who calls it.
pub(super) fn introduce(components: &[Arc<ComponentCell>], executors: &[Executor]) {
    for (index, cell) in components.iter().enumerate() {
        if let Some((wake, _)) = wake_of(executors, index)
            && let Some(mut component) = cell.enter(SETUP_TOKEN, std::time::Duration::ZERO)
        {
            component.run_by(wake);
        }
    }
}

/// What wakes the executor of a component, and whether data do.
pub(crate) fn wake_of(
    executors: &[Executor],
    component: usize,
) -> Option<(Arc<Wake>, ExecutionKind)> {
    executors
        .iter()
        .find(|executor| {
            executor
                .members
                .iter()
                .any(|member| usize::try_from(member.number) == Ok(component))
        })
        .map(|executor| (Arc::clone(&executor.wake), executor.kind))
}

/// One connection being made.
struct Wire<'assembly> {
    specification: &'assembly ApplicationSpecification,
    libraries: &'assembly [LoadedLibrary],
    components: &'assembly [Arc<ComponentCell>],
    connection: &'assembly ConnectionSpecification,
    wake: Option<(Arc<Wake>, ExecutionKind)>,
}

impl Wire<'_> {
    fn data(&self) -> Drops {
        let target = &self.connection.target;
        let declared = self.specification.components[target.component]
            .ports
            .iter()
            .find(|port| port.name == target.port);
        let (policy, queue_size) =
            declared.map_or((QueuePolicy::Last, 1), |port| (port.queue, port.queue_size));
        let size = self.size(&self.connection.source);
        let (sender, receiver) = connection(policy, queue_size, size);
        let drops = receiver.drops();
        // Data wake only executors that have no period: the others look by themselves.
        let wake = self
            .wake
            .as_ref()
            .filter(|(_, kind)| *kind == ExecutionKind::Aperiodic)
            .map(|(wake, _)| Arc::clone(wake));
        self.with_port(&self.connection.source, |port| {
            if let PortEnd::DataOutput(output) = port {
                output.connections.push((sender, wake));
            }
        });
        self.with_port(target, |port| {
            if let PortEnd::DataInput(input) = port {
                input.source = Some(receiver);
            }
        });
        drops
    }

    fn event(&self) {
        let (sender, messages) = mailbox(EVENT_QUEUE, self.size(&self.connection.source));
        let Some((wake, _)) = self.wake.clone() else {
            return;
        };
        self.with_port(&self.connection.source, |port| {
            if let PortEnd::EventOutput(output) = port {
                output.connections.push((sender, wake));
            }
        });
        self.add_inbox(None, messages);
    }

    fn service(&self) {
        let (source, target) = (&self.connection.source, &self.connection.target);
        let (Some(required), Some(provided)) = (
            port_of(self.libraries, source),
            port_of(self.libraries, target),
        ) else {
            return;
        };
        let Some((wake, _)) = self.wake.clone() else {
            return;
        };
        let mut methods = Vec::new();
        for method in &required.methods {
            let Some((index, _)) = provided_method(provided, method) else {
                return;
            };
            let index = u32::try_from(index).unwrap_or(u32::MAX);
            let size = |data_type: &Option<DataType>| data_type.as_ref().map_or(0, |it| it.size);
            let queue = (!method.blocking).then(|| {
                let (sender, messages) = mailbox(CALL_QUEUE, size(&method.request));
                self.add_inbox(Some(index), messages);
                sender
            });
            methods.push(BoundMethod {
                index,
                request: vec![0; size(&method.request)].into_boxed_slice(),
                reply: vec![0; size(&method.reply)].into_boxed_slice(),
                queue,
            });
        }
        let provider = &self.components[target.component];
        provider.share();
        self.components[source.component].share();
        let port = self.port_index(target);
        self.with_port(source, |end| {
            if let PortEnd::Required(calls) = end {
                calls.methods = methods;
                calls.provider = Some(Provider {
                    component: Arc::clone(provider),
                    port,
                    wake,
                });
            }
        });
    }

    fn add_inbox(&self, method: Option<u32>, messages: crate::port::MailReceiver) {
        let target = &self.connection.target;
        let port = self.port_index(target);
        if let Some(mut component) =
            self.components[target.component].enter(SETUP_TOKEN, std::time::Duration::ZERO)
        {
            component.services_mut().add_inbox(Inbox {
                port,
                method,
                messages,
                in_work: None,
                deaths: 0,
            });
        }
    }

    fn size(&self, end: &PortReference) -> usize {
        port_of(self.libraries, end)
            .and_then(|port| port.data_type.as_ref())
            .map_or(0, |data_type| data_type.size)
    }

    fn port_index(&self, end: &PortReference) -> u32 {
        self.libraries[end.component]
            .description
            .ports
            .iter()
            .position(|port| port.name == end.port)
            .and_then(|index| u32::try_from(index).ok())
            .unwrap_or(u32::MAX)
    }

    fn with_port(&self, end: &PortReference, change: impl FnOnce(&mut PortEnd)) {
        let index = self.port_index(end);
        if let Some(mut component) =
            self.components[end.component].enter(SETUP_TOKEN, std::time::Duration::ZERO)
            && let Some(port) = component.services_mut().port_mut(index as usize)
        {
            change(port);
        }
    }
}
