//! Port data: plain structures that may travel through ports, and their descriptors.
#![allow(unsafe_code)] // `PortData` is an unsafe trait: it promises that every bit pattern is valid

use component_abi::{FieldDescriptor, ScalarKind, Text, TypeDescriptor};

/// Data that may travel through a port: `#[repr(C)]`, fixed size, no pointers. Derive it.
///
/// # Safety
/// Every bit pattern of the right size must be a valid value, and the descriptor must describe
/// the layout truly.
pub unsafe trait PortData: Copy + 'static {
    /// The layout of the type.
    const DESCRIPTOR: &'static TypeDescriptor;
}

/// What an event may carry: port data, or nothing, which is `()`.
pub trait EventContent: sealed::EveryBitPatternIsValid + Copy + 'static {
    /// The layout of the type, if there is anything in it.
    const DATA_TYPE: Option<&'static TypeDescriptor>;
}

mod sealed {
    /// What [`super::PortData`] promises; kept to it and `()`.
    pub trait EveryBitPatternIsValid {}

    impl<Data: super::PortData> EveryBitPatternIsValid for Data {}
    impl EveryBitPatternIsValid for () {}
}

impl<Data: PortData> EventContent for Data {
    const DATA_TYPE: Option<&'static TypeDescriptor> = Some(Data::DESCRIPTOR);
}

impl EventContent for () {
    const DATA_TYPE: Option<&'static TypeDescriptor> = None;
}

/// A type that a field of port data may have: a number, an array, or port data itself.
///
/// # Safety
/// As for [`PortData`]; the constants must describe the type truly.
pub unsafe trait FieldType: Copy + 'static {
    /// The kind of one element.
    const KIND: ScalarKind;
    /// Number of elements.
    const COUNT: usize;
    /// Descriptor of a nested structure, else `None`.
    const NESTED: Option<&'static TypeDescriptor>;
}

macro_rules! scalars {
    ($($scalar:ty = $kind:ident),*) => { $(
        // SAFETY: every bit pattern of a number is a number.
        unsafe impl FieldType for $scalar {
            const KIND: ScalarKind = ScalarKind::$kind;
            const COUNT: usize = 1;
            const NESTED: Option<&'static TypeDescriptor> = None;
        }
        // SAFETY: as above; the descriptor has the one field that there is.
        unsafe impl PortData for $scalar {
            const DESCRIPTOR: &'static TypeDescriptor = &{
                const FIELDS: &[FieldDescriptor] = &[FieldDescriptor {
                    name: Text::new("value"),
                    unit: Text::EMPTY,
                    offset: 0,
                    kind: ScalarKind::$kind as u32,
                    reserved: 0,
                    count: 1,
                    nested: core::ptr::null(),
                }];
                TypeDescriptor {
                    name: Text::new(stringify!($scalar)),
                    size: size_of::<$scalar>(),
                    alignment: align_of::<$scalar>(),
                    layout_hash: field_hash::<$scalar>(
                        type_hash(stringify!($scalar), size_of::<$scalar>()),
                        "value",
                        0,
                    ),
                    fields: FIELDS.as_ptr(),
                    field_count: 1,
                }
            };
        }
    )* };
}

scalars!(
    u8 = U8,
    u16 = U16,
    u32 = U32,
    u64 = U64,
    i8 = I8,
    i16 = I16,
    i32 = I32,
    i64 = I64,
    f32 = F32,
    f64 = F64
);

// SAFETY: an array of valid elements is valid; its elements stand one after the other.
unsafe impl<Element: FieldType, const LENGTH: usize> FieldType for [Element; LENGTH] {
    const KIND: ScalarKind = Element::KIND;
    const COUNT: usize = Element::COUNT * LENGTH;
    const NESTED: Option<&'static TypeDescriptor> = Element::NESTED;
}

/// Start of a layout hash: name and size of the type.
pub const fn type_hash(name: &str, size: usize) -> u64 {
    mix(mix_text(FNV_OFFSET, name), size as u64)
}

/// Adds a field to a layout hash.
pub const fn field_hash<Field: FieldType>(hash: u64, name: &str, offset: usize) -> u64 {
    let hash = mix(mix_text(hash, name), offset as u64);
    let hash = mix(mix(hash, Field::KIND as u64), Field::COUNT as u64);
    match Field::NESTED {
        Some(nested) => mix(hash, nested.layout_hash),
        None => hash,
    }
}

/// Offset basis and prime of the 64-bit FNV-1a hash: stable across compilers, unlike `TypeId`.
const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const FNV_PRIME: u64 = 0x0100_0000_01b3;

const fn mix_text(mut hash: u64, text: &str) -> u64 {
    let bytes = text.as_bytes();
    let mut index = 0;
    while index < bytes.len() {
        hash = (hash ^ bytes[index] as u64).wrapping_mul(FNV_PRIME);
        index += 1;
    }
    hash
}

const fn mix(mut hash: u64, number: u64) -> u64 {
    let bytes = number.to_le_bytes();
    let mut index = 0;
    while index < bytes.len() {
        hash = (hash ^ bytes[index] as u64).wrapping_mul(FNV_PRIME);
        index += 1;
    }
    hash
}
