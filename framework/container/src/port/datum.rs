//! A datum on its way between two components, with its origin.

/// One datum. Origin and content lie together at the start of a cache line, so that as few lines
/// as possible wander between the cores of writer and reader; the handle itself never changes.
#[derive(Debug)]
pub struct Datum {
    buffer: Box<[u8]>,
    /// Where in the buffer a cache line starts.
    start: usize,
}

/// Time stamp (8 bytes), incarnation (4), nothing (4): content is aligned to 16 bytes, as
/// components in C may expect.
const ORIGIN_BYTES: usize = 16;
const STAMP: std::ops::Range<usize> = 0..8;
const INCARNATION: std::ops::Range<usize> = 8..12;

/// Of x86-64 and ARM64 processors.
const CACHE_LINE_BYTES: usize = 64;

impl Datum {
    /// A datum of `size` bytes, all zero.
    pub fn empty(size: usize) -> Self {
        let buffer = vec![0u8; ORIGIN_BYTES + size + CACHE_LINE_BYTES - 1].into_boxed_slice();
        let start = buffer.as_ptr().align_offset(CACHE_LINE_BYTES);
        // The offset is below a line's length wherever alignment can be had, which is not promised.
        let start = if start < CACHE_LINE_BYTES { start } else { 0 };
        Self { buffer, start }
    }

    /// When it was written, by the container's clock, in nanoseconds.
    pub fn stamp_ns(&self) -> u64 {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&self.origin()[STAMP]);
        u64::from_ne_bytes(bytes)
    }

    /// Incarnation of the instance that wrote it.
    pub fn incarnation(&self) -> u32 {
        let mut bytes = [0; 4];
        bytes.copy_from_slice(&self.origin()[INCARNATION]);
        u32::from_ne_bytes(bytes)
    }

    /// Says when and by whom it was written.
    #[inline]
    pub fn set_origin(&mut self, stamp_ns: u64, incarnation: u32) {
        let origin = &mut self.buffer[self.start..self.start + ORIGIN_BYTES];
        origin[STAMP].copy_from_slice(&stamp_ns.to_ne_bytes());
        origin[INCARNATION].copy_from_slice(&incarnation.to_ne_bytes());
    }

    /// The content.
    #[inline]
    pub fn bytes(&self) -> &[u8] {
        let end = self.buffer.len() + 1 - CACHE_LINE_BYTES + self.start;
        &self.buffer[self.start + ORIGIN_BYTES..end]
    }

    /// The content, to be filled.
    #[inline]
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        let end = self.buffer.len() + 1 - CACHE_LINE_BYTES + self.start;
        &mut self.buffer[self.start + ORIGIN_BYTES..end]
    }

    /// Takes over origin and content of a datum of the same size.
    pub fn copy_from(&mut self, other: &Self) {
        self.set_origin(other.stamp_ns(), other.incarnation());
        self.bytes_mut().copy_from_slice(other.bytes());
    }

    fn origin(&self) -> &[u8] {
        &self.buffer[self.start..self.start + ORIGIN_BYTES]
    }
}

impl Clone for Datum {
    fn clone(&self) -> Self {
        let mut clone = Self::empty(self.bytes().len());
        clone.copy_from(self);
        clone
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origin_and_content_are_kept_apart_and_copied_together() {
        for size in [0, 1, 48, 64, 4096] {
            let mut datum = Datum::empty(size);
            assert_eq!(datum.bytes().len(), size);
            assert_eq!(datum.bytes().as_ptr().align_offset(16), 0, "{size}");
            datum.set_origin(u64::MAX, 7);
            datum.bytes_mut().fill(3);
            let copy = datum.clone();
            assert_eq!((copy.stamp_ns(), copy.incarnation()), (u64::MAX, 7));
            assert!(copy.bytes().len() == size && copy.bytes().iter().all(|byte| *byte == 3));
        }
    }
}
