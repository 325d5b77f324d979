//! The last seconds.

use std::collections::VecDeque;
use std::time::Duration;

use super::Kept;
use crate::clock::nanoseconds;
use crate::recording::record_file::Entry;

/// What a message takes besides its content.
const OVERHEAD_BYTES: usize = size_of::<Kept>();

/// The last seconds of all messages, as far as there is room.
#[derive(Debug, Default)]
pub(super) struct Memory {
    kept: VecDeque<Kept>,
    bytes: usize,
    most_bytes: usize,
    length_ns: u64,
}

impl Memory {
    /// Of this length, and at most so many bytes.
    pub(super) fn new(length: Duration, most_bytes: usize) -> Self {
        Self {
            length_ns: nanoseconds(length),
            most_bytes,
            ..Self::default()
        }
    }

    /// Keeps a message, and lets go of what is too old or too much.
    pub(super) fn keep(&mut self, entry: &Entry<'_>) {
        self.bytes += entry.content.len() + OVERHEAD_BYTES;
        self.kept.push_back(Kept {
            source: entry.source,
            log_ns: entry.log_ns,
            publish_ns: entry.publish_ns,
            content: entry.content.into(),
        });
        let oldest_ns = entry.log_ns.saturating_sub(self.length_ns);
        while let Some(first) = self.kept.front()
            && (first.log_ns < oldest_ns || self.bytes > self.most_bytes)
        {
            self.bytes -= first.content.len() + OVERHEAD_BYTES;
            self.kept.pop_front();
        }
    }

    /// What is there since then.
    pub(super) fn since(&self, begins_ns: u64) -> impl Iterator<Item = Entry<'_>> {
        let recent = self.kept.iter().filter(move |it| it.log_ns >= begins_ns);
        recent.map(|kept| Entry {
            source: kept.source,
            log_ns: kept.log_ns,
            publish_ns: kept.publish_ns,
            content: &kept.content,
        })
    }
}

#[cfg(test)]
mod tests {
    use recording::Topic;

    use super::*;
    use crate::recording::record_file::Source;

    #[test]
    fn is_bounded_by_time_and_by_bytes() {
        for (most_bytes, expected) in [(usize::MAX, 5..=10), (3 * (OVERHEAD_BYTES + 4), 8..=10)] {
            let mut memory = Memory::new(Duration::from_nanos(5), most_bytes);
            for time_ns in 0u32..=10 {
                memory.keep(&Entry {
                    source: Source::Topic(Topic::Events),
                    log_ns: time_ns.into(),
                    publish_ns: time_ns.into(),
                    content: &time_ns.to_ne_bytes(),
                });
            }
            let times: Vec<u64> = memory.since(0).map(|entry| entry.log_ns).collect();
            assert_eq!(times, expected.collect::<Vec<_>>());
            let last = memory.since(10).last().map(|entry| entry.content.to_vec());
            assert_eq!(last, Some(10u32.to_ne_bytes().to_vec()));
        }
    }
}
