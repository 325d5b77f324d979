//! Percentiles of times.

use std::fmt;

use serde::{Deserialize, Serialize};

/// What is told of a set of times, in microseconds with two decimals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
    /// 99.9th percentile; of fewer than a thousand times the greatest.
    pub p999: f64,
    /// The greatest.
    pub max: f64,
}

impl Percentiles {
    /// Of times in nanoseconds, which are sorted by it; each percentile is one of the times (nearest
    /// rank: the least that so many are not above). `None` without any.
    pub fn of(samples_ns: &mut [u64]) -> Option<Self> {
        samples_ns.sort_unstable();
        let rank = |per_mille| nearest_rank(samples_ns, per_mille).map(microseconds);
        Some(Self {
            p50: rank(500)?,
            p99: rank(990)?,
            p999: rank(999)?,
            max: rank(1000)?,
        })
    }
}

impl fmt::Display for Percentiles {
    /// The four in columns, in microseconds.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            p50,
            p99,
            p999,
            max,
        } = self;
        write!(formatter, "{p50:>10.1}{p99:>10.1}{p999:>10.1}{max:>10.1}")
    }
}

/// The least of times, sorted already, that so many thousandths of them are not above; `None` without
/// any.
pub fn nearest_rank(sorted: &[u64], per_mille: usize) -> Option<u64> {
    let rank = (sorted.len() * per_mille).div_ceil(1000);
    sorted.get(rank.saturating_sub(1)).copied()
}

/// Two decimals: below that a clock read is no measurement.
fn microseconds(time_ns: u64) -> f64 {
    #[allow(clippy::cast_precision_loss)] // beyond 2^53 ns, 104 days
    let hundredths = (time_ns as f64 / 10.0).round();
    hundredths / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn four(p50: f64, p99: f64, p999: f64, max: f64) -> Percentiles {
        Percentiles {
            p50,
            p99,
            p999,
            max,
        }
    }

    #[test]
    fn each_percentile_is_the_least_time_that_so_many_are_not_above() {
        let cases: [(Vec<u64>, Option<Percentiles>); 5] = [
            (vec![], None),
            (vec![1_234], Some(four(1.23, 1.23, 1.23, 1.23))),
            (vec![3_000, 1_000, 2_000], Some(four(2.0, 3.0, 3.0, 3.0))),
            (
                (1..=100).rev().map(|it| it * 1000).collect(),
                Some(four(50.0, 99.0, 100.0, 100.0)),
            ),
            (
                (1..=10_000).map(|it| it * 100).collect(),
                Some(four(500.0, 990.0, 999.0, 1000.0)),
            ),
        ];
        for (mut samples_ns, expected) in cases {
            let count = samples_ns.len();
            assert_eq!(Percentiles::of(&mut samples_ns), expected, "of {count}");
        }
    }
}
