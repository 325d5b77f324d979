//! The result as a table and as JSON.

use std::io::{self, Write};

use super::results::{FloorRow, LoadRow, RecoveryRow, Results};

/// What the paper had: fault to recovered, in microseconds (Ahn et al. 2012, table 5).
const PAPER_US: f64 = 20_000.0;

/// Writes the table for people.
pub(super) fn write_text(output: &mut impl Write, results: &Results) -> io::Result<()> {
    writeln!(output, "{}", results.machine)?;
    for LoadRow {
        load_percent,
        achieved_percent,
    } in &results.loads
    {
        writeln!(
            output,
            "\nload {load_percent} % (all processors {achieved_percent:.0} % busy); microseconds\n"
        )?;
        let floor = &results.floor;
        for row in floor.iter().filter(|row| row.load_percent == *load_percent) {
            write_floor(output, row)?;
        }
        write_head(output)?;
        let rows = &results.rows;
        for row in rows.iter().filter(|row| row.load_percent == *load_percent) {
            write_row(output, row)?;
        }
    }
    write_remarks(output, results)
}

fn write_floor(output: &mut impl Write, row: &FloorRow) -> io::Result<()> {
    let FloorRow { name, n, us, .. } = row;
    writeln!(
        output,
        "{:<40}{n:>6}{:>33}{us}",
        format!("floor: {name}"),
        ""
    )
}

fn write_head(output: &mut impl Write) -> io::Result<()> {
    writeln!(
        output,
        "{:<9}{:<14}{:<17}{:>6}{:>11}{:>11}{:>11}{:>10}{:>10}{:>10}{:>10}{:>6}{:>6}",
        "tier",
        "fault",
        "handling",
        "n",
        "detection",
        "decision",
        "handling",
        "total p50",
        "p99",
        "p99.9",
        "max",
        "lost",
        "twice"
    )
}

fn write_row(output: &mut impl Write, row: &RecoveryRow) -> io::Result<()> {
    let count = |count: Option<u64>| count.map_or_else(|| "-".to_owned(), |it| it.to_string());
    writeln!(
        output,
        "{:<9}{:<14}{:<17}{:>6}{:>11.1}{:>11.1}{:>11.1}{}{:>6}{:>6}",
        row.tier,
        row.fault,
        row.handling,
        row.n,
        row.detection_us.p50,
        row.decision_us.p50,
        row.handling_us.p50,
        row.total_us,
        count(row.lost),
        count(row.duplicated),
    )
}

fn write_remarks(output: &mut impl Write, results: &Results) -> io::Result<()> {
    writeln!(
        output,
        "\ndetection, decision, handling: medians. A hang counts from its deadline, a datum out of \
         range from when it was written.\nEnd: the first completed callback of who took over; of an \
         emergency stop, that the actuator has worked on its safe command."
    )?;
    for row in &results.rows {
        let RecoveryRow {
            tier,
            fault,
            handling,
            load_percent,
            ..
        } = row;
        if row.total_us.p999 > PAPER_US {
            writeln!(
                output,
                "over 20 ms at p99.9: {tier}, {fault}, {handling}, load {load_percent} %: {}",
                reason(results, row)
            )?;
        }
        if row.notes.len() > 1 {
            let notes = row.notes.iter();
            let notes = notes.map(|(note, count)| format!("{count} {}", named(note)));
            let notes: Vec<String> = notes.collect();
            writeln!(
                output,
                "not the same every time: {tier}, {fault}, {handling}, load {load_percent} %: {}",
                notes.join("; ")
            )?;
        }
    }
    Ok(())
}

/// Why a row takes so long, where it can be known.
fn reason(results: &Results, row: &RecoveryRow) -> &'static str {
    let made_at_once = |note: &String| note.split(',').next() == Some("by a fresh instance");
    if !results.machine.real_time {
        "executors share the processors with the load"
    } else if row.notes.keys().any(made_at_once) {
        "a library was loaded on the way, because no standby was ready"
    } else {
        "the reason is not known"
    }
}

fn named(note: &str) -> &str {
    if note.is_empty() { "in place" } else { note }
}

/// Writes one JSON object.
pub(super) fn write_json(output: &mut impl Write, results: &Results) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *output, results)?;
    writeln!(output)
}
