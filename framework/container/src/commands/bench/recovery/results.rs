//! All that was measured, in the form in which it is written.

use std::collections::BTreeMap;

use serde::Serialize;

use super::evaluation::{Row, Times};
use super::floor::Operation;
use super::scenario::{Group, Handling};
use crate::commands::bench::machine::Machine;
use crate::commands::bench::percentiles::Percentiles;

/// Everything that was measured.
#[derive(Debug, Serialize)]
pub(super) struct Results {
    /// Where.
    pub(super) machine: Machine,
    /// What the parts take by themselves.
    pub(super) floor: Vec<FloorRow>,
    /// How busy the processors were.
    #[serde(skip)]
    pub(super) loads: Vec<LoadRow>,
    /// Faults and their handling.
    pub(super) rows: Vec<RecoveryRow>,
    /// What could not be measured, and why.
    #[serde(skip)]
    pub(super) failures: Vec<String>,
}

/// One operation at one load.
#[derive(Debug, Serialize)]
pub(super) struct FloorRow {
    /// Of the operation.
    pub(super) name: String,
    /// That was asked for.
    pub(super) load_percent: u8,
    /// How often it was measured.
    pub(super) n: usize,
    /// How long it took, in microseconds.
    pub(super) us: Percentiles,
}

/// What a load came to.
#[derive(Debug)]
pub(super) struct LoadRow {
    /// What was asked for.
    pub(super) load_percent: u8,
    /// What all processors together were busy, by whomever.
    pub(super) achieved_percent: f64,
}

/// One fault, one handling, one load.
#[derive(Debug, Serialize)]
pub(super) struct RecoveryRow {
    /// Where the component ran.
    pub(super) tier: &'static str,
    /// What happened to it.
    pub(super) fault: &'static str,
    /// What was done about it.
    pub(super) handling: &'static str,
    /// That was asked for.
    pub(super) load_percent: u8,
    /// How often it was measured.
    pub(super) n: usize,
    /// From the fault until it was confirmed.
    pub(super) detection_us: Percentiles,
    /// From there until the plan was made.
    pub(super) decision_us: Percentiles,
    /// From there to the end.
    pub(super) handling_us: Percentiles,
    /// From the fault until the first callback of who took over was completed, or the actuator had
    /// worked on its safe command.
    pub(super) total_us: Percentiles,
    /// Data that never came through, beyond what the dead instance had in work; null where an
    /// emergency stop keeps data back.
    pub(super) lost: Option<u64>,
    /// Data that came through twice.
    pub(super) duplicated: Option<u64>,
    /// How faults were handled, in the words of the verdicts, where it was not the same every time.
    #[serde(skip)]
    pub(super) notes: BTreeMap<String, u32>,
}

impl Results {
    /// Nothing yet, of this machine.
    pub(super) fn of(machine: Machine) -> Self {
        Self {
            machine,
            floor: Vec::new(),
            loads: Vec::new(),
            rows: Vec::new(),
            failures: Vec::new(),
        }
    }
}

impl FloorRow {
    /// The row of an operation; none if it was never done.
    pub(super) fn new(mut operation: Operation, load_percent: u8) -> Option<Self> {
        Some(Self {
            us: Percentiles::of(&mut operation.samples_ns)?,
            n: operation.samples_ns.len(),
            name: operation.name,
            load_percent,
        })
    }
}

impl RecoveryRow {
    /// The rows of a group, each from what all its batches say of it. One of which nothing was
    /// measured is left out.
    pub(super) fn of_group(group: &Group, load_percent: u8, measured: &[Row]) -> Vec<Self> {
        let handlings = group.handlings.iter();
        let row = |handling: &Handling| {
            let parts = measured.iter().filter(|part| part.handling == *handling);
            Self::of_parts(group, *handling, load_percent, &parts.collect::<Vec<_>>())
        };
        handlings.filter_map(row).collect()
    }

    fn of_parts(
        group: &Group,
        handling: Handling,
        load_percent: u8,
        parts: &[&Row],
    ) -> Option<Self> {
        let times = || parts.iter().flat_map(|part| &part.times);
        let percentiles = |of: fn(&Times) -> u64| {
            let mut samples_ns: Vec<u64> = times().map(of).collect();
            Percentiles::of(&mut samples_ns)
        };
        let sum = |of: fn(&Row) -> Option<u64>| parts.iter().map(|part| of(part)).sum();
        let mut notes = BTreeMap::new();
        for (note, count) in parts.iter().flat_map(|part| &part.notes) {
            *notes.entry(note.clone()).or_default() += count;
        }
        Some(Self {
            tier: group.tier.name(),
            fault: group.fault.name(),
            handling: handling.name(),
            load_percent,
            n: times().count(),
            detection_us: percentiles(|it| it.detection_ns)?,
            decision_us: percentiles(|it| it.decision_ns)?,
            handling_us: percentiles(|it| it.handling_ns)?,
            total_us: percentiles(Times::total_ns)?,
            lost: sum(|part| part.lost),
            duplicated: sum(|part| part.duplicated),
            notes,
        })
    }
}
