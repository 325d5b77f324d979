//! The container's ends of a component's ports.

use std::sync::Arc;

use super::cell::ComponentCell;
use crate::port::{MailReceiver, MailSender, Receiver, Sender};
use crate::wake::Wake;

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
