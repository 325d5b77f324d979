//! Finding the start of a frame in a stream.

/// Number of bytes at the head of `bytes` that cannot begin a frame. The first bytes of a start
/// mark at the very end may.
pub(crate) fn bytes_before(start_mark: &[u8], bytes: &[u8]) -> usize {
    (0..bytes.len())
        .find(|&at| {
            let length = start_mark.len().min(bytes.len() - at);
            bytes[at..at + length] == start_mark[..length]
        })
        .unwrap_or(bytes.len())
}
