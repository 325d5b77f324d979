//! The leaves: what each node over components does in a tick.

pub(super) mod control;
pub(super) mod data;
pub(super) mod evaluation;
pub(super) mod faults;
pub(super) mod messages;
pub(super) mod running;
pub(super) mod service;
pub(super) mod states;

use std::time::Duration;

use behavior_tree::{LeafContext, Value};

/// A time in milliseconds at a port.
///
/// # Errors
/// What stands there is no time.
fn milliseconds(context: &LeafContext<'_>, port: &str) -> Result<Duration, String> {
    let number = number(context, port)?;
    Duration::try_from_secs_f64(number / 1e3)
        .map_err(|_| format!("port {port} needs a time in milliseconds, and has {number}"))
}

/// A number at a port.
///
/// # Errors
/// What stands there is none.
fn number(context: &LeafContext<'_>, port: &str) -> Result<f64, String> {
    let value = context.input(port);
    let number = value.and_then(Value::as_number);
    number.ok_or_else(|| match value {
        Some(value) => format!("port {port} needs a number, and has `{value}`"),
        None => format!("port {port} needs a number, and has nothing"),
    })
}
