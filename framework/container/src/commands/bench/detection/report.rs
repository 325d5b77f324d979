//! The result as a table and as JSON.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::study::{Curve, Point, Study, quantile_of};

/// Writes the table for people.
pub(super) fn write_text(output: &mut impl Write, study: &Study) -> io::Result<()> {
    let extent = study.extent;
    writeln!(
        output,
        "Left motor driver off: {} drives with the fault, {} h of driving without, boards {}.\n",
        extent.seeds,
        extent.hours,
        if extent.in_step {
            "in step"
        } else {
            "out of step by chance"
        },
    )?;
    writeln!(
        output,
        "{:<12}{:<24}{:>10}{:>14}{:>10}{:>10}{:>9}",
        "method", "parameters", "threshold", "alarms/24 h", "median", "p95", "missed"
    )?;
    for curve in &study.curves {
        match curve.best() {
            Some(point) => write_point(output, curve, point)?,
            None => writeln!(
                output,
                "{:<12}{:<24}no threshold gives at most one alarm in 24 h",
                curve.method, curve.parameters
            )?,
        }
    }
    let floor = |quantile| written_ms(quantile_of(&study.floor_ms, quantile));
    let ticks = |quantile| quantile_of(&study.missing_ticks_after_80_ms, quantile);
    writeln!(
        output,
        "{:<60}{:>10}{:>10}\n",
        "first encoder count that differs at all",
        floor(0.5),
        floor(0.95)
    )?;
    writeln!(
        output,
        "Each row: the lowest threshold with at most one false alarm in 24 h.\n\
         The last row is physics: until then the data are those of a sane robot, to the bit; no\n\
         detector can know. 80 ms after the fault the left wheels lack {} encoder ticks in the\n\
         median of the drives, {} in the 95th percentile.",
        ticks(0.5),
        ticks(0.95)
    )
}

fn write_point(output: &mut impl Write, curve: &Curve, point: &Point) -> io::Result<()> {
    writeln!(
        output,
        "{:<12}{:<24}{:>10.4}{:>14.2}{:>10}{:>10}{:>9}",
        curve.method,
        curve.parameters,
        point.threshold,
        point.alarms_per_hour * 24.0,
        written_ms(point.quantile_ms(0.5)),
        written_ms(point.quantile_ms(0.95)),
        point
            .delays_ms
            .iter()
            .filter(|delay| delay.is_infinite())
            .count(),
    )
}

fn written_ms(delay_ms: f64) -> String {
    match delay_ms.is_finite() {
        true => format!("{delay_ms:.0} ms"),
        false => "never".into(),
    }
}

/// Writes one JSON object; a delay of a fault that was not found is null.
pub(super) fn write_json(output: &mut impl Write, study: &Study) -> io::Result<()> {
    let delay = |delay_ms: f64| delay_ms.is_finite().then_some(delay_ms);
    let point = |point: &Point| {
        json!({
            "threshold": point.threshold,
            "alarms_per_hour": point.alarms_per_hour,
            "median_ms": delay(point.quantile_ms(0.5)),
            "p95_ms": delay(point.quantile_ms(0.95)),
            "delays_ms": point.delays_ms.iter().copied().map(delay).collect::<Vec<_>>(),
        })
    };
    let curve = |curve: &Curve| {
        json!({
            "method": curve.method,
            "parameters": curve.parameters,
            "best": curve.best().map(point),
            "points": curve.points.iter().map(point).collect::<Value>(),
        })
    };
    let result = json!({
        "seeds": study.extent.seeds,
        "hours": study.extent.hours,
        "in_step": study.extent.in_step,
        "floor_ms": study.floor_ms.iter().copied().map(delay).collect::<Vec<_>>(),
        "missing_ticks_after_80_ms": study.missing_ticks_after_80_ms,
        "curves": study.curves.iter().map(curve).collect::<Value>(),
    });
    writeln!(output, "{result:#}")
}
