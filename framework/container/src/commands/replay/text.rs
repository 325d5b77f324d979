//! What a replay came to, for a person.

use std::io::{self, Write};
use std::time::Duration;

use container::replay::Score;
use fault_manager::{Evidence, Verdict};
use indicatif::ProgressBar;

use super::Replayed;

/// How far the replay is, for a person at a terminal.
pub(super) struct Progress(ProgressBar);

impl Progress {
    /// Nothing played yet. Invisible where nobody watches.
    pub(super) fn new(score: &Score) -> Self {
        let bar = ProgressBar::new_spinner();
        let progress = Self(bar);
        progress.refresh(score);
        progress
    }

    /// Shows how far it is.
    pub(super) fn refresh(&self, score: &Score) {
        let played = score.last_ns() - score.first_ns();
        let played = Duration::from_nanos(played).as_secs_f64();
        self.0
            .set_message(format!("{played:.1} s, {} data", score.data()));
    }

    /// Takes it away.
    pub(super) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// Prints the result.
pub(super) fn print(output: &mut impl Write, replayed: &Replayed) -> io::Result<()> {
    writeln!(
        output,
        "{}: {} data of {:.3} s to {:.3} s{}",
        replayed.recording.display(),
        replayed.data,
        replayed.from_s,
        replayed.to_s,
        if replayed.was_cut {
            ", where the file was cut"
        } else {
            ""
        }
    )?;
    for (what, names) in [
        ("nothing in it of", &replayed.missing),
        ("not in the application", &replayed.ignored),
    ] {
        if !names.is_empty() {
            writeln!(output, "  {what}: {}", names.join(", "))?;
        }
    }
    match replayed.faults.len() {
        0 => writeln!(output, "  these rules confirm no fault")?,
        count => writeln!(output, "  these rules confirm {count}:")?,
    }
    for verdict in &replayed.faults {
        writeln!(output, "    {}", confirmed(verdict))?;
    }
    if !replayed.recorded_faults.is_empty() {
        writeln!(output, "  when it was recorded:")?;
    }
    for fault in &replayed.recorded_faults {
        writeln!(
            output,
            "    [{:10.3}] {}: {}",
            seconds(fault.confirmed_ns),
            fault.component,
            fault.kind
        )?;
    }
    if let Some(file) = replayed.output.as_ref().and_then(|it| it.file.as_ref()) {
        writeln!(output, "  recording of the replay: {}", file.display())?;
    }
    output.flush()
}

fn confirmed(verdict: &Verdict) -> String {
    let rule = verdict.rule.as_ref().map(|rule| format!(", by {rule}"));
    format!(
        "[{:10.3}] {}: {}, first seen at {:.3} s{}{}",
        seconds(verdict.confirmed_ns),
        verdict.component,
        verdict.kind,
        seconds(verdict.first_symptom_ns),
        evidence(&verdict.evidence),
        rule.unwrap_or_default()
    )
}

/// The figures by which a rule can be tuned.
fn evidence(evidence: &Evidence) -> String {
    match evidence {
        Evidence::Value {
            port, field, value, ..
        } => format!(", {port}.{field} = {}", value.0),
        Evidence::Jump {
            port,
            field,
            rate,
            maximum_per_second,
            ..
        } => format!(
            ", {port}.{field} changed by {:.4} a second, {maximum_per_second} is allowed",
            rate.0
        ),
        Evidence::Frozen { port, count, .. } => format!(", {count} equal data at {port}"),
        Evidence::Age {
            port,
            age_ms,
            maximum_ms,
        } => format!(", {port} was {age_ms:.1} ms old, {maximum_ms} are allowed"),
        Evidence::Residual {
            monitor,
            statistic,
            threshold,
            ..
        } => format!(", {monitor}: {:.5} over {threshold}", statistic.0),
        Evidence::Votes {
            voter,
            value,
            voted,
            ..
        } => format!(", {voter}: {} where {} was voted", value.0, voted.0),
        _ => String::new(),
    }
}

fn seconds(time_ns: u64) -> f64 {
    Duration::from_nanos(time_ns).as_secs_f64()
}
