//! Types of port data, as their descriptors tell: fixed size, flat list of numeric fields.

/// The type of a datum. Nested structures are flattened: their fields read `pose.x`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataType {
    /// Name of the type.
    pub name: String,
    /// Size in bytes.
    pub size: usize,
    /// Hash of name, size and fields; 0 where the library does not give one.
    pub layout_hash: u64,
    /// All numeric fields by offset.
    pub fields: Vec<Field>,
}

/// One numeric field, or an array of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Path from the datum: `distance`, `pose.x`.
    pub path: String,
    /// Physical unit; empty for none.
    pub unit: String,
    /// Offset in bytes from the start of the datum.
    pub offset: usize,
    /// What one element is.
    pub scalar: Scalar,
    /// Number of consecutive elements.
    pub count: usize,
}

/// The numbers that port data is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Scalar {
    /// Unsigned 8 bit.
    U8,
    /// Unsigned 16 bit.
    U16,
    /// Unsigned 32 bit.
    U32,
    /// Unsigned 64 bit.
    U64,
    /// Signed 8 bit.
    I8,
    /// Signed 16 bit.
    I16,
    /// Signed 32 bit.
    I32,
    /// Signed 64 bit.
    I64,
    /// IEEE 754 single.
    F32,
    /// IEEE 754 double.
    F64,
}

impl Scalar {
    /// Size of one element in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

impl DataType {
    /// Whether a port of this type may be connected to one of `other`: same layout hash where both
    /// sides give one, else same name and size.
    pub fn fits(&self, other: &Self) -> bool {
        if self.layout_hash != 0 && other.layout_hash != 0 {
            return self.layout_hash == other.layout_hash;
        }
        self.name == other.name && self.size == other.size
    }
}
