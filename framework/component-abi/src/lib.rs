//! The C contract between the container and a component library.
//!
//! A component library exports one data symbol, [`ENTRY_SYMBOL`], of type [`LibraryDescriptor`].
//! It is data, not a function: the container compares magic, version, size and layout hash before
//! a single instruction of the library has been asked to run.
//!
//! Only `#[repr(C)]` values cross this boundary. Tables grow at their end only; a table's `size`
//! tells where it ends, so an older library stays loadable within one major version.
//!
//! `include/component.h` says the same in C; a test compiles it and compares every size and offset.

#![no_std]

pub mod callback;
pub mod descriptor;
pub mod host;
pub mod status;
pub mod text;

pub use callback::{Callbacks, Instance};
pub use descriptor::{
    ABI_MAGIC, ABI_MAJOR, ABI_MINOR, ENTRY_SYMBOL, FieldDescriptor, Header, LAYOUT_HASH,
    LibraryDescriptor, MethodDescriptor, PortDescriptor, ScalarKind, TypeDescriptor,
    port_direction, port_kind,
};
pub use host::{HostContext, HostTable, LogLevel};
pub use status::Status;
pub use text::Text;
