//! What is told of many times of the same thing.

use crate::commands::bench::percentiles::nearest_rank;

/// Cycles in which everything that does not happen in each of them happens equally often: the
/// monitors are looked at in every fifth, and a backup is taken in every third.
const BLOCK: usize = 15;

/// Times in ns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Times {
    /// How many there are.
    pub(super) count: usize,
    /// Of a single one: median, 99th and 99.9th percentile, and the longest.
    pub(super) percentiles_ns: [u64; 4],
    /// Mean time in the median of the blocks: with all that is not done every time, and without
    /// interruptions from outside.
    pub(super) typical_ns: f64,
}

impl Times {
    /// Of times in the order in which they were taken; `None` without any.
    pub(super) fn of(mut times_ns: Vec<u64>) -> Option<Self> {
        let mut blocks: Vec<f64> = times_ns.chunks(BLOCK).map(mean).collect();
        blocks.sort_by(f64::total_cmp);
        times_ns.sort_unstable();
        let rank = |per_mille| nearest_rank(&times_ns, per_mille);
        Some(Self {
            count: times_ns.len(),
            percentiles_ns: [rank(500)?, rank(990)?, rank(999)?, rank(1000)?],
            typical_ns: *blocks.get(blocks.len() / 2)?,
        })
    }
}

fn mean(times_ns: &[u64]) -> f64 {
    times_ns.iter().sum::<u64>() as f64 / times_ns.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_done_now_and_then_is_part_of_the_typical_time() {
        let every_fifth = |index: u64| if index.is_multiple_of(5) { 600 } else { 100 };
        let mut times_ns: Vec<u64> = (0..3000).map(every_fifth).collect();
        times_ns[7] = 1_000_000;
        let times = Times::of(times_ns).expect("there are some");
        assert_eq!(times.count, 3000);
        assert_eq!(times.percentiles_ns, [100, 600, 600, 1_000_000]);
        assert!((times.typical_ns - 200.0).abs() < 1e-9, "{times:?}");
        assert_eq!(Times::of(Vec::new()), None);
    }
}
