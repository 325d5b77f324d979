//! The result as tables and as JSON.

use std::io::{self, Write};

use serde_json::{Map, Value, json};

use super::memory::QUANTITIES;
use super::rules::Rules;
use super::study::{ChainRow, Study};
use super::times::Times;
use crate::commands::bench::machine::Machine;

/// Writes tables for people.
pub(super) fn write_text(
    output: &mut impl Write,
    study: &Study,
    machine: &Machine,
) -> io::Result<()> {
    writeln!(output, "{machine}\n")?;
    write_chains(output, study)?;
    write_memory(output, study)?;
    write_start(output, study)
}

fn write_chains(output: &mut impl Write, study: &Study) -> io::Result<()> {
    writeln!(
        output,
        "Chains of components, one thread. Free running: cycles as fast as they go, all work of the\n\
         fault manager on that thread. At 1 kHz: from the first write to the last read in real time.\n"
    )?;
    writeln!(
        output,
        "{:>10}  {:<8}{:<7}{:>11}{:>12}{:>11}{:>11}{:>7}{:>13}{:>11}",
        "components",
        "tier",
        "rules",
        "cycles/s",
        "cycle, ns",
        "p99",
        "ns each",
        "ratio",
        "1 kHz, us",
        "p99"
    )?;
    write_chain(output, study, &study.stopwatches)?;
    for row in &study.chains {
        write_chain(output, study, row)?;
    }
    writeln!(
        output,
        "\nThe first row is the stopwatches at both ends alone; it is taken off before 'ns each' is\n\
         divided. Ratio: to the same chain without rules. n = {} cycles, {} at 1 kHz, in {} rounds.\n",
        study.stopwatches.cycle.count, study.stopwatches.latency.count, study.rounds
    )
}

fn write_chain(output: &mut impl Write, study: &Study, row: &ChainRow) -> io::Result<()> {
    let [cycle, cycle_p99, ..] = row.cycle.percentiles_ns;
    let [latency, latency_p99, ..] = row.latency.percentiles_ns.map(|ns| ns as f64 / 1e3);
    writeln!(
        output,
        "{:>10}  {:<8}{:<7}{:>11.0}{cycle:>12}{cycle_p99:>11}{:>11}{:>7}{latency:>13.1}{latency_p99:>11.1}",
        row.components,
        row.tier,
        row.rules.name(),
        throughput_hz(&row.cycle),
        optional(row.components > 0, format!("{:.0}", row.per_component_ns)),
        study
            .ratio(row)
            .map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.2}")),
    )
}

fn optional(is_there: bool, text: String) -> String {
    match is_there {
        true => text,
        false => "-".to_owned(),
    }
}

fn write_memory(output: &mut impl Write, study: &Study) -> io::Result<()> {
    writeln!(
        output,
        "Memory of each component with a thread of its own, in KiB: resident, with what processes\n\
         share divided among them, and copies of libraries, of which the mapped part is resident, too.\n"
    )?;
    writeln!(
        output,
        "{:<8}{:<16}{:>10}{:>10}{:>10}{:>9}{:>12}{:>10}{:>11}",
        "tier", "rules", "RSS", "PSS", "copies", "threads", "open files", "mappings", "processes"
    )?;
    for row in &study.memory {
        let [rss, pss, copies, threads, files, mappings, processes] = row.each.0;
        writeln!(
            output,
            "{:<8}{:<16}{rss:>10.0}{pss:>10.0}{copies:>10.0}{threads:>9.1}{files:>12.1}{mappings:>10.1}{processes:>11.1}",
            row.tier,
            row.rules.name(),
        )?;
    }
    writeln!(output)
}

fn write_start(output: &mut impl Write, study: &Study) -> io::Result<()> {
    writeln!(
        output,
        "From the start of the process until the last component, each with a thread of its own, has\n\
         begun its first cycle, in ms, median of {} rounds.\n",
        study.rounds
    )?;
    writeln!(
        output,
        "{:>10}  {:<8}{:>10}{:>10}{:>10}{:>10}{:>10}",
        "components", "tier", "all", "read", "load", "bring up", "launch"
    )?;
    for row in &study.start {
        let start = row.start;
        writeln!(
            output,
            "{:>10}  {:<8}{:>10.1}{:>10.1}{:>10.1}{:>10.1}{:>10.1}",
            row.components,
            row.tier,
            start.total_ms(),
            start.read_ms,
            start.load_ms,
            start.bring_up_ms,
            start.launch_ms
        )?;
    }
    Ok(())
}

/// Writes one JSON object.
pub(super) fn write_json(
    output: &mut impl Write,
    study: &Study,
    machine: &Machine,
) -> io::Result<()> {
    let chains = std::iter::once(&study.stopwatches).chain(&study.chains);
    let memory = study.memory.iter().map(|row| {
        let each = QUANTITIES.iter().zip(row.each.0);
        let mut object: Map<String, Value> = each
            .map(|(name, number)| ((*name).to_owned(), json!(number)))
            .collect();
        object.insert("tier".to_owned(), json!(row.tier));
        object.insert("rules".to_owned(), json!(row.rules.name()));
        Value::Object(object)
    });
    let start = study.start.iter().map(|row| {
        json!({
            "components": row.components,
            "tier": row.tier,
            "ms": row.start.total_ms(),
            "read_ms": row.start.read_ms,
            "load_ms": row.start.load_ms,
            "bring_up_ms": row.start.bring_up_ms,
            "launch_ms": row.start.launch_ms,
        })
    });
    let result = json!({
        "machine": machine,
        "rounds": study.rounds,
        "chains": chains.map(|row| chain(study, row)).collect::<Value>(),
        "memory": memory.collect::<Value>(),
        "start": start.collect::<Value>(),
    });
    writeln!(output, "{result:#}")
}

fn chain(study: &Study, row: &ChainRow) -> Value {
    json!({
        "components": row.components,
        "rules": row.rules.name(),
        "tier": row.tier,
        "cycle_ns": percentiles(&row.cycle, 1.0),
        "per_component_ns": (row.components > 0).then_some(row.per_component_ns),
        "ratio": study.ratio(row),
        "latency_us": percentiles(&row.latency, 1e3),
        "throughput_hz": throughput_hz(&row.cycle),
    })
}

fn percentiles(times: &Times, unit_ns: f64) -> Value {
    let [p50, p99, p999, max] = times.percentiles_ns.map(|ns| ns as f64 / unit_ns);
    json!({ "n": times.count, "p50": p50, "p99": p99, "p999": p999, "max": max })
}

/// Cycles in a second, if all are as they typically are.
fn throughput_hz(cycle: &Times) -> f64 {
    1e9 / cycle.typical_ns
}

impl Study {
    /// The time of a cycle over that of the same chain, in the same tier, without rules.
    fn ratio(&self, row: &ChainRow) -> Option<f64> {
        if row.rules == Rules::None {
            return None;
        }
        let same = |other: &&ChainRow| {
            other.rules == Rules::None
                && other.tier == row.tier
                && other.components == row.components
        };
        let without = self.chains.iter().find(same)?;
        Some(row.cycle.typical_ns / without.cycle.typical_ns)
    }
}
