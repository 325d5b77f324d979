//! What a library says of itself: versions, ports, types.
#![allow(unsafe_code)] // one `Sync` impl: descriptors are exported as statics

use crate::callback::Callbacks;
use crate::text::Text;

/// First bytes of every header.
pub const ABI_MAGIC: u64 = u64::from_le_bytes(*b"STEADFST");
/// Libraries and containers of different major versions do not work together.
pub const ABI_MAJOR: u32 = 1;
/// A library's minor version must not exceed the container's.
pub const ABI_MINOR: u32 = 0;
/// The data symbol that a component library exports.
pub const ENTRY_SYMBOL: &str = "steadfast_component";

/// Start of every table: who made it, for which version, and how long it is.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// [`ABI_MAGIC`].
    pub magic: u64,
    /// [`ABI_MAJOR`] of the maker.
    pub major: u32,
    /// [`ABI_MINOR`] of the maker.
    pub minor: u32,
    /// Size of the whole table in bytes.
    pub size: u64,
    /// [`LAYOUT_HASH`] of the maker: sizes of all tables and of a pointer.
    pub layout_hash: u64,
}

impl Header {
    /// A header for a table of `size` bytes, of this version.
    pub const fn new(size: usize) -> Self {
        Self {
            magic: ABI_MAGIC,
            major: ABI_MAJOR,
            minor: ABI_MINOR,
            size: size as u64,
            layout_hash: LAYOUT_HASH,
        }
    }
}

/// The sizes of all tables of this major version, mixed: differs where compilers, pointer widths
/// or forked headers disagree although the version number agrees.
pub const LAYOUT_HASH: u64 = {
    let sizes = [
        size_of::<usize>(),
        size_of::<Header>(),
        size_of::<Text>(),
        size_of::<Callbacks>(),
        size_of::<PortDescriptor>(),
        size_of::<MethodDescriptor>(),
        size_of::<TypeDescriptor>(),
        size_of::<FieldDescriptor>(),
    ];
    let mut hash = 0u64;
    let mut index = 0;
    while index < sizes.len() {
        hash = hash.wrapping_mul(1_000_003) + sizes[index] as u64;
        index += 1;
    }
    hash
};

/// What a component library exports under [`ENTRY_SYMBOL`].
#[repr(C)]
#[derive(Clone, Copy)]
pub struct LibraryDescriptor {
    /// Version and size of this table.
    pub header: Header,
    /// Name of the component type.
    pub name: Text,
    /// Version of the component, free text.
    pub version: Text,
    /// First of `port_count` ports; a port's index is its name in every call.
    pub ports: *const PortDescriptor,
    /// Number of ports.
    pub port_count: usize,
    /// The callbacks.
    pub callbacks: Callbacks,
}

// SAFETY: a descriptor is immutable from the moment the library is mapped; its pointers lead to
// immutable statics of the same library, which is never unloaded.
unsafe impl Sync for LibraryDescriptor {}

/// Kinds of port, as numbers.
pub mod port_kind {
    /// Data port.
    pub const DATA: u32 = 0;
    /// Event port.
    pub const EVENT: u32 = 1;
    /// Service port.
    pub const SERVICE: u32 = 2;
}

/// Directions of ports, as numbers.
pub mod port_direction {
    /// `input`; `provided` for a service.
    pub const INPUT: u32 = 0;
    /// `output`; `required` for a service.
    pub const OUTPUT: u32 = 1;
}

/// One port.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct PortDescriptor {
    /// Name, unique in the component.
    pub name: Text,
    /// One of [`port_kind`].
    pub kind: u32,
    /// One of [`port_direction`].
    pub direction: u32,
    /// Type of the datum or event content; null for services and for events without content.
    pub data_type: *const TypeDescriptor,
    /// Methods of a service port.
    pub methods: *const MethodDescriptor,
    /// Number of methods.
    pub method_count: usize,
}

/// One method of a service.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct MethodDescriptor {
    /// Name; required and provided methods are matched by it.
    pub name: Text,
    /// 1 if the caller waits for the reply, 0 if the call is queued.
    pub blocking: u32,
    /// 0.
    pub reserved: u32,
    /// Type of the request; null for none.
    pub request: *const TypeDescriptor,
    /// Type of the reply; null for none.
    pub reply: *const TypeDescriptor,
}

/// The type of a datum: plain data of fixed size in which every bit pattern is valid.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TypeDescriptor {
    /// Name of the type.
    pub name: Text,
    /// Size in bytes.
    pub size: usize,
    /// Alignment in bytes.
    pub alignment: usize,
    /// Hash of name, size and all fields; two ports connect only if it agrees. 0: not given (plain
    /// C), then name and size must agree.
    pub layout_hash: u64,
    /// Fields in order of their offset.
    pub fields: *const FieldDescriptor,
    /// Number of fields.
    pub field_count: usize,
}

/// What a field holds.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScalarKind {
    /// A nested structure; see `nested`.
    Structure = 0,
    /// Unsigned 8 bit.
    U8 = 1,
    /// Unsigned 16 bit.
    U16 = 2,
    /// Unsigned 32 bit.
    U32 = 3,
    /// Unsigned 64 bit.
    U64 = 4,
    /// Signed 8 bit.
    I8 = 5,
    /// Signed 16 bit.
    I16 = 6,
    /// Signed 32 bit.
    I32 = 7,
    /// Signed 64 bit.
    I64 = 8,
    /// IEEE 754 single.
    F32 = 9,
    /// IEEE 754 double.
    F64 = 10,
}

/// One field of a type.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct FieldDescriptor {
    /// Name of the field.
    pub name: Text,
    /// Physical unit (`m`, `rad/s`); empty for none.
    pub unit: Text,
    /// Offset in bytes from the start of the structure.
    pub offset: usize,
    /// One of [`ScalarKind`], as a number: a library may be newer than the container.
    pub kind: u32,
    /// 0.
    pub reserved: u32,
    /// Number of consecutive elements, 1 for a single value.
    pub count: usize,
    /// Type of a nested structure; null for scalars.
    pub nested: *const TypeDescriptor,
}
