//! What an author of Steadfast components uses.
//!
//! A component is a type with life-cycle callbacks ([`Component`]) and a set of typed ports
//! (`#[derive(Ports)]`), exported from a `cdylib` by [`export_component!`]. It may keep
//! `#![forbid(unsafe_code)]`. It need not know that it is watched: what happens when it fails is
//! written by the integrator, in XML.
//!
//! ```
//! #![forbid(unsafe_code)]
//! use component_sdk::prelude::*;
//!
//! #[derive(PortData, Clone, Copy)]
//! #[repr(C)]
//! pub struct Temperature {
//!     #[unit("K")]
//!     value: f64,
//! }
//!
//! #[derive(Ports)]
//! pub struct ThermostatPorts {
//!     measured: Input<Temperature>,
//!     corrected: Output<Temperature>,
//! }
//!
//! pub struct Thermostat {
//!     ports: ThermostatPorts,
//!     offset: f64,
//! }
//!
//! impl Component for Thermostat {
//!     type Ports = ThermostatPorts;
//!
//!     fn new(ports: ThermostatPorts) -> Self {
//!         Self { ports, offset: 0.0 }
//!     }
//!
//!     fn on_initialize(&mut self, context: &Context) -> Outcome {
//!         self.offset = context.property_or("offset", 0.0)?;
//!         Ok(())
//!     }
//!
//!     fn on_execute(&mut self, _context: &Context) -> Outcome {
//!         if let Some(measured) = self.ports.measured.read() {
//!             self.ports.corrected.write(&Temperature { value: measured.value + self.offset });
//!         }
//!         Ok(())
//!     }
//! }
//!
//! export_component!(Thermostat);
//! # fn main() {}
//! ```

mod component;
mod context;
mod data;
mod export;
mod port;
mod service;

pub use component::{Component, Failure, Outcome};
pub use component_abi::Status;
pub use component_sdk_derive::{PortData, Ports};
pub use context::Context;
pub use data::{EventContent, FieldType, PortData};
pub use port::{Event, EventInput, EventOutput, Input, Output, Port, PortSet};
pub use service::{Call, Provided, Required, ServiceType};

/// All that a component usually needs.
pub mod prelude {
    pub use crate::{
        Call, Component, Context, Event, EventInput, EventOutput, Failure, Input, Outcome, Output,
        PortData, Ports, Provided, Required, ServiceType, Status, export_component, service_type,
    };
}

/// What the macros expand to; not for use by hand.
#[doc(hidden)]
pub mod expansion {
    pub use crate::context::Host;
    pub use crate::data::{field_hash, type_hash};
    pub use crate::export::descriptor;
    pub use component_abi::{
        FieldDescriptor, HostContext, HostTable, LibraryDescriptor, MethodDescriptor,
        PortDescriptor, ScalarKind, Text, TypeDescriptor,
    };
}
