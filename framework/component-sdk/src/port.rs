//! Typed ports: handles that know their index and their data type.

use std::marker::PhantomData;

use component_abi::{
    MethodDescriptor, PortDescriptor, Status, TypeDescriptor, port_direction, port_kind,
};

use crate::context::Host;
use crate::data::{EventContent, PortData};

/// A set of ports: derive it for a struct whose fields are ports.
pub trait PortSet: 'static {
    /// The ports in order; a port's position is its index.
    const PORTS: &'static [PortDescriptor];
    /// Makes the handles.
    #[doc(hidden)]
    fn bind(host: Host) -> Self;
}

impl PortSet for () {
    const PORTS: &'static [PortDescriptor] = &[];
    fn bind(_host: Host) -> Self {}
}

/// One kind of port handle.
pub trait Port: 'static {
    /// One of [`port_kind`].
    const KIND: u32;
    /// One of [`port_direction`].
    const DIRECTION: u32;
    /// Type of its data, if it carries any.
    const DATA_TYPE: Option<&'static TypeDescriptor>;
    /// Methods, if it is a service.
    const METHODS: &'static [MethodDescriptor];
    /// Makes the handle.
    #[doc(hidden)]
    fn bind(host: Host, index: u32) -> Self;
}

/// A data input.
pub struct Input<Data> {
    host: Host,
    index: u32,
    latest: Option<Data>,
}

/// A data output.
pub struct Output<Data> {
    host: Host,
    index: u32,
    marker: PhantomData<fn(Data)>,
}

/// An event input; see [`crate::Component::on_event`]. Of events without content: `EventInput<()>`.
pub struct EventInput<Content> {
    index: u32,
    marker: PhantomData<fn() -> Content>,
}

/// An event output. Of events without content: `EventOutput<()>`.
pub struct EventOutput<Content> {
    host: Host,
    index: u32,
    marker: PhantomData<fn(Content)>,
}

impl<Data: PortData> Input<Data> {
    /// The next datum that has not been read yet, if there is one.
    pub fn read(&mut self) -> Option<Data> {
        let datum = self.host.read(self.index);
        if datum.is_some() {
            self.latest = datum;
        }
        datum
    }

    /// Reads everything that has arrived and gives the last datum that was ever read.
    pub fn latest(&mut self) -> Option<Data> {
        while self.read().is_some() {}
        self.latest
    }
}

impl<Data: PortData> Output<Data> {
    /// Sends a datum to every connected input; true if the container took it.
    pub fn write(&self, datum: &Data) -> bool {
        self.host.write(self.index, datum).is_success()
    }
}

impl<Content: EventContent> EventOutput<Content> {
    /// Sends an event to every connected input.
    ///
    /// # Errors
    /// OUT_OF_RESOURCES if a receiver's queue is full; the others got it.
    pub fn raise(&self, content: &Content) -> Result<(), Status> {
        match self.host.raise(self.index, content) {
            status if status.is_success() => Ok(()),
            status => Err(status),
        }
    }
}

/// An event that arrived, with the port by which it came.
pub struct Event<'callback> {
    port: u32,
    content: &'callback [u8],
}

impl<'callback> Event<'callback> {
    pub(crate) fn new(port: u32, content: &'callback [u8]) -> Self {
        Self { port, content }
    }

    /// Index of the port, in the order of the port set.
    pub fn port(&self) -> u32 {
        self.port
    }

    /// The content as bytes.
    pub fn bytes(&self) -> &'callback [u8] {
        self.content
    }
}

impl<Content: EventContent> EventInput<Content> {
    /// The event's content if it came by this port.
    pub fn content(&self, event: &Event<'_>) -> Option<Content> {
        (event.port == self.index)
            .then(|| crate::export::datum_from(event.content))
            .flatten()
    }
}

macro_rules! port {
    ($handle:ident<$bound:ident>, $kind:ident, $direction:ident, |$host:ident, $index:ident| $bind:expr) => {
        impl<Data: $bound> Port for $handle<Data> {
            const KIND: u32 = port_kind::$kind;
            const DIRECTION: u32 = port_direction::$direction;
            const DATA_TYPE: Option<&'static TypeDescriptor> = Data::DATA_TYPE;
            const METHODS: &'static [MethodDescriptor] = &[];
            fn bind($host: Host, $index: u32) -> Self {
                $bind
            }
        }
    };
}

port!(Input<PortData>, DATA, INPUT, |host, index| Self {
    host,
    index,
    latest: None
});
port!(Output<PortData>, DATA, OUTPUT, |host, index| Self {
    host,
    index,
    marker: PhantomData
});
port!(EventInput<EventContent>, EVENT, INPUT, |_host, index| {
    Self {
        index,
        marker: PhantomData,
    }
});
port!(EventOutput<EventContent>, EVENT, OUTPUT, |host, index| {
    Self {
        host,
        index,
        marker: PhantomData,
    }
});
