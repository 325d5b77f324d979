//! Service ports: methods that one component provides and another requires.

use std::marker::PhantomData;
use std::time::Duration;

use component_abi::{MethodDescriptor, Status, TypeDescriptor, port_direction, port_kind};

use crate::component::Failure;
use crate::context::Host;
use crate::data::PortData;
use crate::port::Port;

/// A service: a set of methods. Made by [`crate::service_type!`].
pub trait ServiceType: 'static {
    /// The methods in order; a method's position is its index.
    const METHODS: &'static [MethodDescriptor];
    /// Their names, in the same order.
    const NAMES: &'static [&'static str];
}

/// A required service: calls leave through it.
pub struct Required<Service> {
    host: Host,
    index: u32,
    marker: PhantomData<fn() -> Service>,
}

/// A provided service: calls arrive at [`crate::Component::on_call`].
pub struct Provided<Service> {
    index: u32,
    marker: PhantomData<fn() -> Service>,
}

/// A call that arrived.
pub struct Call<'callback> {
    port: u32,
    method: u32,
    request: &'callback [u8],
    reply: &'callback mut [u8],
}

impl<Service: ServiceType> Required<Service> {
    /// Calls a blocking method and waits for the reply, at most `deadline`.
    ///
    /// # Errors
    /// UNSUPPORTED_METHOD for an unknown name, BAD_INPUT_PARAMETER for the wrong types,
    /// PRECONDITION_NOT_MET if nothing is connected, TIMED_OUT, or the callee's own failure.
    pub fn call<Request: PortData, Reply: PortData>(
        &self,
        method: &str,
        request: &Request,
        deadline: Duration,
    ) -> Result<Reply, Failure> {
        let index = self.position(method)?;
        self.host
            .call(self.index, index, request, deadline)
            .map_err(|status| Failure::new(status, format!("call of '{method}' failed")))
    }

    /// Queues a call of a nonblocking method.
    ///
    /// # Errors
    /// As for [`Self::call`]; OUT_OF_RESOURCES if the callee's queue is full.
    pub fn send<Request: PortData>(&self, method: &str, request: &Request) -> Result<(), Failure> {
        let index = self.position(method)?;
        match self.host.send(self.index, index, request) {
            status if status.is_success() => Ok(()),
            status => Err(Failure::new(
                status,
                format!("call of '{method}' was not queued"),
            )),
        }
    }

    fn position(&self, method: &str) -> Result<u32, Failure> {
        Service::NAMES
            .iter()
            .position(|name| *name == method)
            .and_then(|index| u32::try_from(index).ok())
            .ok_or_else(|| {
                Failure::new(
                    Status::UNSUPPORTED_METHOD,
                    format!("the service has no method '{method}'"),
                )
            })
    }
}

impl<Service: ServiceType> Provided<Service> {
    /// The method's name if the call came by this port.
    pub fn method(&self, call: &Call<'_>) -> Option<&'static str> {
        (call.port == self.index)
            .then(|| Service::NAMES.get(call.method as usize).copied())
            .flatten()
    }
}

impl<'callback> Call<'callback> {
    pub(crate) fn new(
        port: u32,
        method: u32,
        request: &'callback [u8],
        reply: &'callback mut [u8],
    ) -> Self {
        Self {
            port,
            method,
            request,
            reply,
        }
    }

    /// The request as a `Request`.
    ///
    /// # Errors
    /// BAD_INPUT_PARAMETER if its size is not that of `Request`.
    pub fn request<Request: PortData>(&self) -> Result<Request, Failure> {
        crate::export::datum_from(self.request).ok_or_else(|| {
            Failure::new(
                Status::BAD_INPUT_PARAMETER,
                format!("the request has {} bytes", self.request.len()),
            )
        })
    }

    /// Sets the reply.
    ///
    /// # Errors
    /// BAD_INPUT_PARAMETER if the caller expects another size.
    pub fn reply<Reply: PortData>(&mut self, reply: &Reply) -> Result<(), Failure> {
        if self.reply.len() == size_of::<Reply>() {
            crate::export::copy_into(self.reply, reply);
            return Ok(());
        }
        Err(Failure::new(
            Status::BAD_INPUT_PARAMETER,
            format!("the caller expects a reply of {} bytes", self.reply.len()),
        ))
    }
}

macro_rules! service_port {
    ($handle:ident, $direction:ident, |$host:ident, $index:ident| $bind:expr) => {
        impl<Service: ServiceType> Port for $handle<Service> {
            const KIND: u32 = port_kind::SERVICE;
            const DIRECTION: u32 = port_direction::$direction;
            const DATA_TYPE: Option<&'static TypeDescriptor> = None;
            const METHODS: &'static [MethodDescriptor] = Service::METHODS;
            fn bind($host: Host, $index: u32) -> Self {
                $bind
            }
        }
    };
}

service_port!(Required, OUTPUT, |host, index| Self {
    host,
    index,
    marker: PhantomData
});
service_port!(Provided, INPUT, |_host, index| Self {
    index,
    marker: PhantomData
});

/// Declares a service type: its methods with request and reply types.
///
/// ```
/// use component_sdk::prelude::*;
/// service_type! {
///     /// Where the robot is.
///     pub Localisation {
///         blocking distance_to(f64) -> f64;
///         nonblocking forget(u32);
///     }
/// }
/// # fn main() { assert_eq!(Localisation::NAMES, ["distance_to", "forget"]); }
/// ```
#[macro_export]
macro_rules! service_type {
    (
        $(#[$attribute:meta])*
        $visibility:vis $service:ident {
            $( $mode:ident $method:ident ( $request:ty ) $( -> $reply:ty )? ; )*
        }
    ) => {
        $(#[$attribute])*
        $visibility struct $service;
        impl $crate::ServiceType for $service {
            const NAMES: &'static [&'static str] = &[ $( stringify!($method) ),* ];
            const METHODS: &'static [$crate::expansion::MethodDescriptor] = &[ $(
                $crate::expansion::MethodDescriptor {
                    name: $crate::expansion::Text::new(stringify!($method)),
                    blocking: $crate::service_type!(@blocking $mode),
                    reserved: 0,
                    request: <$request as $crate::PortData>::DESCRIPTOR,
                    reply: $crate::service_type!(@reply $( $reply )?),
                }
            ),* ];
        }
    };
    (@blocking blocking) => { 1 };
    (@blocking nonblocking) => { 0 };
    (@reply $reply:ty) => { <$reply as $crate::PortData>::DESCRIPTOR };
    (@reply) => { ::core::ptr::null() };
}
