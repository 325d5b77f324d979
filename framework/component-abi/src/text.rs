//! Text across the boundary: pointer and length, UTF-8, not terminated.

/// Borrowed UTF-8 text. Null with length 0 is the empty text.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Text {
    /// First byte; may be null only if `length` is 0.
    pub data: *const u8,
    /// Length in bytes.
    pub length: usize,
}

impl Text {
    /// The empty text.
    pub const EMPTY: Self = Self {
        data: core::ptr::null(),
        length: 0,
    };

    /// Borrows a string; the receiver must not keep it beyond the call or the static's life.
    pub const fn new(text: &str) -> Self {
        Self {
            data: text.as_ptr(),
            length: text.len(),
        }
    }
}
