//! Which chains are run, and what comes of them.

use std::io;
use std::time::Duration;

use indicatif::ProgressBar;

use super::application::{Chain, Execution};
use super::extent::{Extent, TierExtent};
use super::memory::Footprint;
use super::rules::Rules;
use super::times::Times;
use super::trial::{self, Pace, Start};

/// Period of components that have a thread each, in ms: their work is not what is looked at.
const ALONE_PERIOD_MS: u32 = 100;

/// What the rules ask for where memory is looked at.
const MEMORY: [Rules; 4] = [
    Rules::None,
    Rules::All,
    Rules::Standby("loaded"),
    Rules::Standby("warm"),
];

/// How long an application runs whose start is measured, in the container's time: longer than all
/// its threads take to begin.
const START_RUN: Duration = Duration::from_secs(1);

/// A chain, all rounds together.
#[derive(Debug)]
pub(super) struct ChainRow {
    /// Components.
    pub(super) components: usize,
    /// What the rules ask for.
    pub(super) rules: Rules,
    /// The isolation tier.
    pub(super) tier: &'static str,
    /// Time of a cycle, running free.
    pub(super) cycle: Times,
    /// Time from the first write to the last read, in real time.
    pub(super) latency: Times,
    /// What each component adds to the time of a cycle, in ns.
    pub(super) per_component_ns: f64,
}

/// Memory that each component takes.
#[derive(Debug)]
pub(super) struct MemoryRow {
    /// What the rules ask for.
    pub(super) rules: Rules,
    /// The isolation tier.
    pub(super) tier: &'static str,
    /// What each component takes.
    pub(super) each: Footprint,
}

/// Time to start, the median of the rounds.
#[derive(Debug)]
pub(super) struct StartRow {
    /// Components.
    pub(super) components: usize,
    /// The isolation tier.
    pub(super) tier: &'static str,
    /// Its phases.
    pub(super) start: Start,
}

/// Everything that was found.
#[derive(Debug)]
pub(super) struct Study {
    /// Rounds.
    pub(super) rounds: u32,
    /// The stopwatches alone, without a component between them: what is not the chain's.
    pub(super) stopwatches: ChainRow,
    /// Chains.
    pub(super) chains: Vec<ChainRow>,
    /// Memory.
    pub(super) memory: Vec<MemoryRow>,
    /// Start.
    pub(super) start: Vec<StartRow>,
}

impl Study {
    /// Runs everything.
    ///
    /// # Errors
    /// If a run fails.
    pub(super) fn run(extent: &Extent, progress: &ProgressBar) -> io::Result<Self> {
        let mut growing = chains(extent);
        let rounds = extent.rounds as usize;
        let starts: usize = extent.tiers.iter().map(|it| it.start.len()).sum();
        let runs = (growing.len() * 2 + starts) * rounds + MEMORY.len() * extent.tiers.len() * 2;
        progress.set_length(runs as u64);
        for _ in 0..rounds {
            for chain in &mut growing {
                chain.grow(extent, progress)?;
            }
        }
        let mut rows = finish(growing)?.into_iter();
        let stopwatches = rows.next();
        Ok(Self {
            rounds: extent.rounds,
            stopwatches: stopwatches.ok_or_else(|| io::Error::other("no cycle was measured"))?,
            chains: rows.collect(),
            memory: memory(extent, progress)?,
            start: start(extent, progress)?,
        })
    }
}

/// A chain whose rounds are not over.
struct Growing {
    chain: Chain,
    /// Of a free run.
    cycles: u32,
    cycles_ns: Vec<u64>,
    passages_ns: Vec<u64>,
}

impl Growing {
    fn grow(&mut self, extent: &Extent, progress: &ProgressBar) -> io::Result<()> {
        progress.set_message(format!("chain of {}", self.chain.components));
        let free = trial::run(&self.chain, Pace::Free(self.cycles))?;
        self.cycles_ns.extend(free.cycles_ns);
        progress.inc(1);
        let periodic = trial::run(&self.chain, Pace::Periodic(extent.real_time))?;
        self.passages_ns.extend(periodic.passages_ns);
        progress.inc(1);
        Ok(())
    }
}

/// The stopwatches alone, then all chains, those that are compared next to each other.
fn chains(extent: &Extent) -> Vec<Growing> {
    let growing = |components, rules, of: &TierExtent| Growing {
        chain: Chain {
            components,
            execution: Execution::Together,
            rules,
            tier: of.tier,
            samples: of.samples,
        },
        cycles: of.cycles,
        cycles_ns: Vec::new(),
        passages_ns: Vec::new(),
    };
    let mut chains = vec![growing(0, Rules::None, &extent.tiers[0])];
    for components in &extent.lengths {
        for tier in &extent.tiers {
            for rules in [Rules::None, Rules::All] {
                chains.push(growing(*components, rules, tier));
            }
        }
    }
    chains
}

fn finish(growing: Vec<Growing>) -> io::Result<Vec<ChainRow>> {
    let mut alone_ns = 0.0;
    let rows = growing.into_iter().map(|growing| {
        let chain = growing.chain;
        let nothing = || {
            let (tier, components) = (chain.tier, chain.components);
            io::Error::other(format!(
                "nothing came through a chain of {components} components ({tier})"
            ))
        };
        let cycle = Times::of(growing.cycles_ns).ok_or_else(nothing)?;
        let latency = Times::of(growing.passages_ns).ok_or_else(nothing)?;
        if chain.components == 0 {
            alone_ns = cycle.typical_ns;
        }
        Ok(ChainRow {
            components: chain.components,
            rules: chain.rules,
            tier: chain.tier,
            per_component_ns: (cycle.typical_ns - alone_ns) / chain.components.max(1) as f64,
            cycle,
            latency,
        })
    });
    rows.collect()
}

/// Each has its application twice, of different size: what both have is not the components'.
fn memory(extent: &Extent, progress: &ProgressBar) -> io::Result<Vec<MemoryRow>> {
    let mut rows = Vec::new();
    for TierExtent { tier, memory, .. } in &extent.tiers {
        for rules in MEMORY {
            progress.set_message(format!("memory, {tier}, {}", rules.name()));
            let mut sizes = [Footprint::default(); 2];
            for (size, components) in sizes.iter_mut().zip(*memory) {
                let chain = Chain {
                    components,
                    execution: Execution::Alone(ALONE_PERIOD_MS),
                    rules,
                    tier,
                    samples: 0,
                };
                *size = trial::settle(&chain)?.footprint.unwrap_or_default();
                progress.inc(1);
            }
            let [smaller, larger] = sizes;
            rows.push(MemoryRow {
                rules,
                tier,
                each: larger.each(&smaller, memory[1] - memory[0]),
            });
        }
    }
    Ok(rows)
}

fn start(extent: &Extent, progress: &ProgressBar) -> io::Result<Vec<StartRow>> {
    let mut rows = Vec::new();
    for TierExtent { tier, start, .. } in &extent.tiers {
        for components in start {
            progress.set_message(format!("start of {components}"));
            let chain = Chain {
                components: *components,
                execution: Execution::Alone(ALONE_PERIOD_MS),
                rules: Rules::None,
                tier,
                samples: 0,
            };
            let mut starts = Vec::new();
            for _ in 0..extent.rounds {
                starts.push(trial::run(&chain, Pace::Periodic(START_RUN))?.start);
                progress.inc(1);
            }
            starts.sort_by(|one, other| one.total_ms().total_cmp(&other.total_ms()));
            rows.extend(starts.get(starts.len() / 2).map(|start| StartRow {
                components: *components,
                tier,
                start: *start,
            }));
        }
    }
    Ok(rows)
}
