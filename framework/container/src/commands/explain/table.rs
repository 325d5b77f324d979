//! The table of every fault of every component, as text and as JSON.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use fault_manager::Scope;
use fault_manager::what_if::{Answer, Cell, Table};
use serde_json::{Value, json};

use super::what_if::{json as answer_json, name, outcome, subject, words};

/// Cells of a row that come out alike: what they end in, the course that they take, and their faults.
pub struct Group<'a> {
    /// What they end in.
    pub outcome: &'static str,
    /// One answer for all of them.
    pub answer: &'a Answer,
    /// `segfault`, or `range drop` for a fault of a port's data.
    pub faults: Vec<String>,
}

/// The cells of a row, alike ones together, in the order of the first of each.
pub fn groups(cells: &[Cell]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for cell in cells {
        let Ok(answer) = &cell.answer else { continue };
        let fault = cell.supposition.fault.name();
        let fault = match &cell.supposition.port {
            Some(port) => format!("{port} {fault}"),
            None => fault.to_owned(),
        };
        let same = |group: &&mut Group<'_>| {
            group.answer.actions() == answer.actions() && group.outcome == outcome(answer)
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.faults.push(fault),
            None => groups.push(Group {
                outcome: outcome(answer),
                answer,
                faults: vec![fault],
            }),
        }
    }
    groups
}

/// Faults that end in nothing, as questions.
pub fn unanswered(scopes: &[Scope], table: &Table) -> Vec<String> {
    let cells = table.rows.iter().flat_map(|row| &row.cells);
    cells
        .filter(|cell| cell.answer.as_ref().is_ok_and(Answer::ends_in_nothing))
        .map(|cell| words(scopes, &cell.supposition))
        .collect()
}

/// Components whose loss stops the robot.
pub fn indispensable(scopes: &[Scope], table: &Table) -> Vec<String> {
    let rows = table.rows.iter();
    rows.filter(|row| row.loss.as_ref().is_ok_and(Answer::stops_robot))
        .map(|row| name(scopes, row.application, row.component))
        .collect()
}

/// For people.
pub fn text(scopes: &[Scope], table: &Table) -> String {
    let mut text = String::new();
    for row in &table.rows {
        let heading = name(scopes, row.application, row.component);
        let _infallible = writeln!(text, "{heading}");
        for group in groups(&row.cells) {
            let _infallible = writeln!(text, "  {}", group.outcome);
            wrap(&mut text, "    if ", &group.faults);
            let actions = steps(group.answer);
            if !actions.is_empty() {
                wrap(&mut text, "    then ", &actions);
            }
        }
        if let Ok(loss) = &row.loss {
            let _infallible = writeln!(text, "  if it cannot be brought back: {}", outcome(loss));
        }
        text.push('\n');
    }
    let stops = indispensable(scopes, table);
    let nothing = by_subject(scopes, table);
    let _infallible = writeln!(text, "Components whose loss stops the robot:");
    wrap(&mut text, "  ", &stops);
    let _infallible = writeln!(text, "\nFaults that end in nothing:");
    for (subject, faults) in nothing {
        wrap(&mut text, &format!("  {subject}: "), &faults);
    }
    text
}

fn by_subject(scopes: &[Scope], table: &Table) -> BTreeMap<String, Vec<String>> {
    let mut all: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for cell in table.rows.iter().flat_map(|row| &row.cells) {
        if cell.answer.as_ref().is_ok_and(Answer::ends_in_nothing) {
            let faults = all.entry(subject(scopes, &cell.supposition)).or_default();
            faults.push(cell.supposition.fault.name().to_owned());
        }
    }
    all
}

/// What is done, steps that follow each other and say the same counted.
pub fn steps(answer: &Answer) -> Vec<String> {
    let actions = answer.actions();
    let runs = actions.chunk_by(|one, other| one == other);
    let steps = runs.map(|run| {
        let step = run[0].strip_suffix(": done").unwrap_or(&run[0]);
        match run.len() {
            1 => step.to_owned(),
            count => format!("{step} ({count} times)"),
        }
    });
    steps.collect()
}

/// Lists words in lines of a width that fits every terminal.
fn wrap(text: &mut String, begin: &str, words: &[String]) {
    const WIDTH: usize = 100;
    let indent = " ".repeat(begin.len());
    let mut line = begin.to_owned();
    for (index, word) in words.iter().enumerate() {
        let last = index + 1 == words.len();
        let word = if last {
            word.clone()
        } else {
            format!("{word}, ")
        };
        if line.len() + word.len() > WIDTH && line.trim() != begin.trim() && line != indent {
            let _infallible = writeln!(text, "{}", line.trim_end());
            line.clone_from(&indent);
        }
        line += &word;
    }
    let _infallible = writeln!(text, "{line}");
}

/// For programs.
pub fn json(scopes: &[Scope], table: &Table) -> Value {
    let cells = |cells: &[Cell]| -> Value {
        let cells = cells.iter().map(|cell| match &cell.answer {
            Ok(answer) => answer_json(scopes, &cell.supposition, answer),
            Err(reason) => json!({
                "component": name(scopes, cell.supposition.application, cell.supposition.component),
                "port": cell.supposition.port,
                "fault": cell.supposition.fault.name(),
                "not_applicable": reason.to_string(),
            }),
        });
        cells.collect()
    };
    let rows = table.rows.iter().map(|row| {
        json!({
            "component": name(scopes, row.application, row.component),
            "cells": cells(&row.cells),
            "loss": row.loss.as_ref().ok().map(outcome),
        })
    });
    json!({
        "rows": rows.collect::<Value>(),
        "loss_stops_robot": indispensable(scopes, table),
        "ends_in_nothing": unanswered(scopes, table),
    })
}
