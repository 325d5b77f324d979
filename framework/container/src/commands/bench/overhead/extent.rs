//! How much is measured: as much as fits into five minutes on two cores.

use std::time::Duration;

/// The isolation tiers that are measured, by the words of the rules.
pub(super) const TIERS: [&str; 2] = ["guarded", "process"];

/// How much is measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Extent {
    /// Components in a chain.
    pub(super) lengths: Vec<usize>,
    /// How long a run in real time takes.
    pub(super) real_time: Duration,
    /// How often everything is run, one after the other.
    pub(super) rounds: u32,
    /// Of each of [`TIERS`].
    pub(super) tiers: [TierExtent; TIERS.len()],
}

/// How much is measured in one tier. A call into a process takes many times what one behind the
/// guard does, and so does the start of a process, so there is less of both.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TierExtent {
    /// By the word of the rules.
    pub(super) tier: &'static str,
    /// Cycles of a free run, and of them the last so many count.
    pub(super) cycles: u32,
    /// Cycles that count.
    pub(super) samples: usize,
    /// Memory: components of the smaller and of the larger application.
    pub(super) memory: [usize; 2],
    /// Start: components of the applications.
    pub(super) start: Vec<usize>,
}

impl Extent {
    /// Within five minutes on two cores.
    pub(super) fn usual() -> Self {
        let [guarded, process] = TIERS;
        Self {
            lengths: vec![1, 2, 4, 8, 16, 32, 64],
            real_time: Duration::from_millis(1500),
            rounds: 3,
            tiers: [
                TierExtent {
                    tier: guarded,
                    cycles: 30_000,
                    samples: 20_000,
                    memory: [10, 110],
                    start: vec![10, 100, 1000],
                },
                TierExtent {
                    tier: process,
                    cycles: 1500,
                    samples: 1000,
                    memory: [5, 25],
                    start: vec![10, 100],
                },
            ],
        }
    }

    /// To see that it works: figures of this mean little.
    pub(super) fn quick() -> Self {
        let of_tier = |tier| TierExtent {
            tier,
            cycles: 300,
            samples: 200,
            memory: [1, 5],
            start: vec![4],
        };
        Self {
            lengths: vec![1, 4],
            real_time: Duration::from_millis(500),
            rounds: 1,
            tiers: TIERS.map(of_tier),
        }
    }
}
