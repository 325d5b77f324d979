//! The result as a table and as JSON.

use std::io::{self, Write};

use serde::Serialize;

use super::floor::Operation;
use crate::commands::bench::machine::Machine;
use crate::commands::bench::percentiles::Percentiles;

/// Everything that was measured.
#[derive(Debug, Serialize)]
pub(super) struct Results {
    /// Where.
    machine: Machine,
    /// What the parts take by themselves.
    pub(super) floor: Vec<FloorRow>,
    /// How busy the processors were.
    pub(super) loads: Vec<LoadRow>,
}

/// One operation at one load.
#[derive(Debug, Serialize)]
pub(super) struct FloorRow {
    name: String,
    load_percent: u8,
    n: usize,
    us: Percentiles,
}

/// What a load came to.
#[derive(Debug, Serialize)]
pub(super) struct LoadRow {
    /// What was asked for.
    pub(super) load_percent: u8,
    /// What all processors together were busy, by whomever.
    pub(super) achieved_percent: f64,
}

impl Results {
    /// Nothing yet, of this machine.
    pub(super) fn of(machine: Machine) -> Self {
        Self {
            machine,
            floor: Vec::new(),
            loads: Vec::new(),
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

/// Writes the table for people.
pub(super) fn write_text(output: &mut impl Write, results: &Results) -> io::Result<()> {
    writeln!(output, "{}\n", results.machine)?;
    for load in &results.loads {
        let LoadRow {
            load_percent,
            achieved_percent,
        } = load;
        writeln!(
            output,
            "load {load_percent} % (all processors {achieved_percent:.0} % busy), microseconds"
        )?;
        let floor = &results.floor;
        for row in floor.iter().filter(|row| row.load_percent == *load_percent) {
            writeln!(output, "  floor: {:<32}{:>6}{}", row.name, row.n, row.us)?;
        }
    }
    Ok(())
}

/// Writes one JSON object.
pub(super) fn write_json(output: &mut impl Write, results: &Results) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *output, results)?;
    writeln!(output)
}
