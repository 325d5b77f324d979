//! Memory that a component names: perhaps not there at all.

use component_abi::Text;

use super::copy::guarded_copy;

/// Bytes that a component names for reading; perhaps not readable at all.
#[derive(Debug, Clone, Copy)]
pub struct ForeignBytes {
    data: *const u8,
    size: usize,
}

/// Bytes that a component names for writing.
#[derive(Debug, Clone, Copy)]
pub struct ForeignBytesMut {
    data: *mut u8,
    size: usize,
}

/// Text that a component names.
#[derive(Debug, Clone, Copy)]
pub struct ForeignText {
    bytes: ForeignBytes,
}

/// Longest text that is taken from a component, in bytes; the rest is cut off.
const LONGEST_TEXT: usize = 4096;

impl ForeignBytes {
    /// Memory by its address.
    pub fn at(address: usize, size: usize) -> Self {
        Self::new(std::ptr::with_exposed_provenance(address), size)
    }

    /// Copies them to the first of other such bytes; false if those are fewer, or either are not
    /// accessible.
    #[must_use]
    pub fn copy_into(self, to: ForeignBytesMut) -> bool {
        // SAFETY: neither side is ours; what is not accessible gives a 'no'.
        self.size <= to.size && unsafe { guarded_copy(to.data, self.data, self.size) }
    }

    pub(super) fn new(data: *const u8, size: usize) -> Self {
        Self { data, size }
    }

    /// How many bytes the component says there are.
    pub fn size(self) -> usize {
        self.size
    }

    /// Copies them to `to`, which must be as long; false if they are not readable.
    #[must_use]
    pub fn copy_to(self, to: &mut [u8]) -> bool {
        // SAFETY: `to` is ours, writable for its length, and checked to be as long.
        to.len() == self.size && unsafe { guarded_copy(to.as_mut_ptr(), self.data, self.size) }
    }
}

impl ForeignBytesMut {
    /// Bytes of ours that are filled like a component's, until the borrow ends.
    pub fn of(bytes: &mut [u8]) -> Self {
        Self::new(bytes.as_mut_ptr(), bytes.len())
    }

    /// Where they are.
    pub fn address(self) -> *mut u8 {
        self.data
    }

    /// Memory that a component has registered, by its address.
    pub fn at(address: usize, size: usize) -> Self {
        let data = std::ptr::with_exposed_provenance_mut(address);
        Self { data, size }
    }

    /// The same memory, for reading.
    pub fn for_reading(self) -> ForeignBytes {
        ForeignBytes::new(self.data, self.size)
    }

    pub(super) fn new(data: *mut u8, size: usize) -> Self {
        Self { data, size }
    }

    /// How many bytes the component says there are.
    pub fn size(self) -> usize {
        self.size
    }

    /// Fills the first of them from `from`; false if `from` is longer or they are not writable.
    #[must_use]
    pub fn copy_from(self, from: &[u8]) -> bool {
        // SAFETY: `from` is ours and readable for its length; the other side is the component's
        // own, as far as it says the truth, and it may write anywhere itself.
        from.len() <= self.size && unsafe { guarded_copy(self.data, from.as_ptr(), from.len()) }
    }
}

impl ForeignText {
    /// Text in such bytes.
    pub fn of(bytes: ForeignBytes) -> Self {
        Self { bytes }
    }

    pub(super) fn new(text: Text) -> Self {
        Self {
            bytes: ForeignBytes {
                data: text.data,
                size: text.length,
            },
        }
    }

    /// The text, cut to a bound; invalid UTF-8 is replaced. `None` if it is not readable.
    pub fn read(self) -> Option<String> {
        let size = self.bytes.size.min(LONGEST_TEXT);
        let mut buffer = vec![0u8; size];
        let bytes = ForeignBytes { size, ..self.bytes };
        bytes
            .copy_to(&mut buffer)
            .then(|| String::from_utf8_lossy(&buffer).into_owned())
    }
}
