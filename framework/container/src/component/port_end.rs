//! The container's ends of a component's ports.

use std::sync::Arc;

use fault_manager::DetectorId;

use super::cell::ComponentCell;
use super::tap::{InputTap, OutputTap};
use crate::port::{
    Datum, Leftover, MOST_DEATHS, MailReceiver, MailSender, Newest, Receiver, Sender,
};
use crate::recording::EventRecorder;
use crate::wake::Wake;

/// The container's end of a port, by the port's index.
pub enum PortEnd {
    /// Data input.
    DataInput(DataInput),
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

/// A data input.
pub struct DataInput {
    /// Size of a datum.
    pub size: usize,
    /// What arrives; none if nothing is connected.
    pub source: Option<Receiver>,
    /// Where the time of the newest datum is left, if another robot feeds it.
    pub newest_from_afar: Option<Arc<Newest>>,
    /// What rules want to know or to change; none without rules.
    pub tap: Option<Box<InputTap>>,
}

/// A data output with its connections.
pub struct DataOutput {
    /// Size of a datum.
    pub size: usize,
    /// One for each connected input, with what wakes its reader.
    pub connections: Vec<(Sender, Option<Arc<Wake>>)>,
    /// What rules want to know; none without rules.
    pub tap: Option<Box<OutputTap>>,
}

/// An event output with its connections.
pub struct EventOutput {
    /// Size of the content.
    pub size: usize,
    /// One for each connected input, with what wakes its receiver.
    pub connections: Vec<(MailSender, Arc<Wake>)>,
    /// By a rule each of its events is a fault.
    pub fault: Option<DetectorId>,
    /// Who puts it down.
    pub recorder: Option<Box<EventRecorder>>,
}

/// Messages that arrive by one connection.
pub struct Inbox {
    /// The port they arrive at, as the first instance of the component numbered it.
    pub port: u32,
    /// The method, for queued calls; `None` for events. Numbered likewise.
    pub method: Option<u32>,
    /// The queue.
    pub messages: MailReceiver,
    /// The message that is being worked on.
    pub in_work: Option<Datum>,
    /// Incarnations that died with it in work.
    pub deaths: u32,
}

impl Inbox {
    /// Takes the next message into work, or once more the one that was in work when the component
    /// died; whether there is one.
    pub fn take(&mut self) -> bool {
        if self.in_work.is_none() {
            self.in_work = self.messages.take();
        }
        self.in_work.is_some()
    }

    /// The message is done with.
    pub fn done(&mut self) {
        self.deaths = 0;
        if let Some(message) = self.in_work.take() {
            self.messages.give_back(message);
        }
    }

    /// Forgets everything that has arrived.
    pub fn clear(&mut self) {
        self.done();
        self.messages.clear();
    }

    /// What becomes of the message in work, if there is one, now that the component died.
    pub fn leave(&mut self) -> Option<Leftover> {
        let stamp_ns = self.in_work.as_ref()?.stamp_ns();
        self.deaths += 1;
        if self.deaths < MOST_DEATHS {
            return Some(Leftover::Again);
        }
        self.done();
        Some(Leftover::SetAside { stamp_ns })
    }
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
