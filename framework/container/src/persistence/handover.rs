//! From the executor that takes a checkpoint to the thread that writes it: neither waits for the
//! other, and only the newest copy counts.

use triple_buffer::{Input, Output, triple_buffer};

/// A copy on its way to the disk.
#[derive(Debug, Clone, Default)]
pub struct SentCopy {
    /// Which of the component's libraries had registered the memory: its own (0) or that of a
    /// secondary (from 1).
    pub variant: usize,
    /// Incarnation that it was taken of.
    pub incarnation: u32,
    /// Number of the checkpoint.
    pub sequence: u64,
    /// When it was taken, in nanoseconds of the container's clock.
    pub taken_ns: u64,
    /// The memory.
    pub memory: Vec<u8>,
}

/// The executor's end.
#[derive(Debug)]
pub struct CopySender(Input<SentCopy>);

/// The writer's end.
#[derive(Debug)]
pub struct CopyReceiver(Output<SentCopy>);

/// Both ends, with room for memory of this size in bytes.
pub fn handover(size: usize) -> (CopySender, CopyReceiver) {
    // Filled, not only reserved: a clone of an empty list would have no room.
    let (input, output) = triple_buffer(&SentCopy {
        memory: vec![0; size],
        ..SentCopy::default()
    });
    (CopySender(input), CopyReceiver(output))
}

impl CopySender {
    /// Hands a copy over in place of the one before, if that was not taken. Wait-free; allocates
    /// only if the memory is larger than any before.
    #[inline]
    pub fn send(
        &mut self,
        variant: usize,
        incarnation: u32,
        sequence: u64,
        taken_ns: u64,
        memory: &[u8],
    ) {
        let copy = self.0.input_buffer_mut();
        (copy.variant, copy.incarnation) = (variant, incarnation);
        (copy.sequence, copy.taken_ns) = (sequence, taken_ns);
        copy.memory.clear();
        copy.memory.extend_from_slice(memory);
        self.0.publish();
    }
}

impl CopyReceiver {
    /// The newest copy, if it was not taken yet.
    pub fn take(&mut self) -> Option<&SentCopy> {
        let fresh = self.0.update();
        fresh.then(|| self.0.output_buffer())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_copy_is_taken_once() {
        let (mut sender, mut receiver) = handover(3);
        assert!(receiver.take().is_none());
        sender.send(0, 1, 1, 10, b"old");
        sender.send(2, 5, 2, 20, b"newer");
        let taken = receiver.take().map(|copy| {
            let numbers = (copy.variant, copy.incarnation, copy.sequence, copy.taken_ns);
            (numbers, copy.memory.clone())
        });
        assert_eq!(taken, Some(((2, 5, 2, 20), b"newer".to_vec())));
        assert!(receiver.take().is_none());
    }
}
