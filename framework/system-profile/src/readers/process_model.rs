//! `process_model`: a reference model for fault detection, as linear state space with noise.
//!
//! ```xml
//! <process_model name="lag">
//!   <state_space kind="continuous" period_ms="20">   <!-- or "discrete" -->
//!     <a>0 1; -4 -2</a> <b>0; 4</b> <c>1 0</c> <d>0</d> <initial>0 0</initial>
//!   </state_space>
//!   <noise><process>0 0.1</process><measurement>0.01</measurement></noise>
//!   <input_delay_ms>20</input_delay_ms> <input_jitter_ms>5</input_jitter_ms>
//!   <inputs>
//!     <input name="speed">
//!       <case when="direction" equals="2"><term field="speed" scale="-1"/></case>
//!       <case><term field="speed"/></case>
//!     </input>
//!   </inputs>
//! </process_model>
//! ```
//!
//! Rows of a matrix are separated by semicolons, numbers by blanks or commas. A covariance may be
//! given by its diagonal. `d`, `initial`, `input_delay_ms` and `input_jitter_ms` may be left out, they are
//! 0 then; `inputs` too, if each input is a number that a rule names. The first case of an input whose field
//! `when` equals a number counts; its terms are added up, and `offset` to them.

mod inputs;
mod matrix;
mod soundness;

use std::ops::RangeInclusive;
use std::path::Path;
use std::time::Duration;

use system_model::process_model::{Matrix, ProcessModel, StateSpace, StateSpaceKind};

use crate::document::Document;
use crate::node::Node;
use crate::problem::Problem;
use crate::suggest::quoted;
use crate::value::Value;
use matrix::{read_covariance, read_matrix, read_vector, unwritten};

/// The outermost element of a model file.
pub(super) const MODEL_ROOT: &str = "process_model";

/// From a motor's current regulator to a process that a robot can wait for.
const PERIOD_MS: RangeInclusive<f64> = 0.1..=10_000.0;
/// A longer delay is a queue that somebody forgot.
const INPUT_DELAY_MS: RangeInclusive<f64> = 0.0..=10_000.0;

/// What came of loading a model.
#[derive(Debug)]
pub struct ProcessModelOutcome {
    /// The model, if its file has no error.
    pub model: Option<ProcessModel>,
    /// All problems of the file, sorted by place.
    pub problems: Vec<Problem>,
}

/// Loads a reference model. Its matrices fit each other, its states do not grow without bound, and
/// its noise is a covariance that a filter can work with.
pub fn load_process_model(path: &Path) -> ProcessModelOutcome {
    load(&Document::open(path))
}

fn load(document: &Document) -> ProcessModelOutcome {
    let model = document.root(&[MODEL_ROOT]).and_then(|root| {
        let model = read(&root);
        root.finish();
        model
    });
    ProcessModelOutcome {
        model: model.filter(|_| !document.has_errors()),
        problems: document.problems(),
    }
}

/// Reads a model; none if a part of it is missing or cannot be understood.
pub(super) fn read(root: &Node<'_>) -> Option<ProcessModel> {
    let name = root.required_attribute("name");
    let space = root.required_child("state_space");
    let state_space = space.as_ref().and_then(|node| {
        let space = state_space(node);
        node.finish();
        space
    });
    let noise = root.required_child("noise");
    let time = |name| match root.value(name) {
        Some(value) => milliseconds(&value, &INPUT_DELAY_MS),
        None => Some(Duration::ZERO),
    };
    let (delay, jitter) = (time("input_delay_ms"), time("input_jitter_ms"));
    let inputs = root.child("inputs");
    let count = state_space.as_ref().map(|space| space.b.columns);
    let inputs = inputs.map(|node| inputs::read(&node, count));
    root.pass_over(&["description", "version", "copyright"]);
    let (states, outputs) = state_space.as_ref().map_or((None, None), |space| {
        (Some(space.a.rows), Some(space.c.rows))
    });
    let (process_noise, measurement_noise) = noise.map_or((None, None), |node| {
        let process = read_covariance(&node, "process", states);
        let measurement = read_covariance(&node, "measurement", outputs);
        if let Some(measurement) = &measurement {
            soundness::check_definite(&node, measurement);
        }
        node.finish();
        (process, measurement)
    });
    Some(ProcessModel {
        name: name?.as_str().to_owned(),
        state_space: state_space?,
        process_noise: process_noise?,
        measurement_noise: measurement_noise?,
        input_delay: delay?,
        input_jitter: jitter?,
        inputs: match inputs {
            Some(inputs) => inputs?,
            None => Vec::new(),
        },
    })
}

fn state_space(node: &Node<'_>) -> Option<StateSpace> {
    let kind = node.required_attribute("kind").and_then(|value| {
        value.choice(&[
            ("continuous", StateSpaceKind::Continuous),
            ("discrete", StateSpaceKind::Discrete),
        ])
    });
    let period = node.required_attribute("period_ms");
    let period = period.and_then(|value| milliseconds(&value, &PERIOD_MS));
    let a = read_matrix(node, "a", None, None);
    let states = a.as_ref().map(|a| a.rows);
    if let Some(a) = a.as_ref().filter(|a| a.rows != a.columns) {
        node.error(
            format!("<a> has {} rows and {} columns", a.rows, a.columns),
            Some("write a square matrix: a row and a column for each state".into()),
        );
    }
    let b = read_matrix(node, "b", states, None);
    let c = read_matrix(node, "c", None, states);
    let inputs = b.as_ref().map(|b| b.columns);
    let outputs = c.as_ref().map(|c| c.rows);
    let d = match unwritten(node, "d") {
        true => inputs
            .zip(outputs)
            .map(|(inputs, outputs)| Matrix::zeros(outputs, inputs)),
        false => read_matrix(node, "d", outputs, inputs),
    };
    let initial = match unwritten(node, "initial") {
        true => states.map(|states| vec![0.0; states]),
        false => read_vector(node, "initial", states),
    };
    let (kind, period, a) = (kind?, period?, a?);
    if a.rows == a.columns {
        soundness::check_stable(node, &a, kind, period);
    }
    Some(StateSpace {
        kind,
        period,
        a,
        b: b?,
        c: c?,
        d: d?,
        initial: initial?,
    })
}

fn milliseconds(value: &Value<'_>, range: &RangeInclusive<f64>) -> Option<Duration> {
    let milliseconds: f64 = value.number()?;
    if range.contains(&milliseconds) {
        return Some(Duration::from_secs_f64(milliseconds / 1000.0));
    }
    value.error(
        format!(
            "`{}` in {} is out of range",
            quoted(value.as_str()),
            value.owner()
        ),
        Some(format!(
            "write milliseconds from {} to {}",
            range.start(),
            range.end()
        )),
    );
    None
}

#[cfg(test)]
mod tests;
