//! The result as a picture: false alarms to the right, delay upwards, one line for each rule.

use std::fmt::Write as _;

use super::study::{Curve, Point, Study, quantile_of};
use crate::commands::bench::drawing::{line, text};

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 520.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 600.0;
const TOP: f64 = 60.0;
const BOTTOM: f64 = 450.0;
const DELAY_MAXIMUM_MS: f64 = 400.0;
/// Alarms in 24 hours at the ends of the axis; fewer than the first are drawn there.
const ALARMS_LEAST: f64 = 0.5;
const ALARMS_MOST: f64 = 20_000.0;
/// One hue for each method, one shade for each set of parameters.
const HUES: [(&str, [&str; 3]); 3] = [
    ("window", ["#08519c", "#4292c6", "#9ecae1"]),
    ("cusum", ["#006d2c", "#41ab5d", "#a1d99b"]),
    ("chi_square", ["#a63603", "#f16913", "#fdae6b"]),
];

/// The picture as SVG.
pub(super) fn draw(study: &Study) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    text(
        &mut svg,
        LEFT,
        26.0,
        "start",
        "Left motor driver off: how soon it is found, at the price of how many false alarms",
    );
    let extent = study.extent;
    let what = format!(
        "{} drives with the fault, {} h without; solid: median, dashed: 95th percentile",
        extent.seeds, extent.hours
    );
    text(&mut svg, LEFT, 44.0, "start", &what);
    axes(&mut svg);
    floor(&mut svg, study);
    let mut shades = [0; 3];
    for (index, curve) in study.curves.iter().enumerate() {
        let hue = HUES.iter().position(|(method, _)| *method == curve.method);
        let hue = hue.unwrap_or_default();
        let colour = HUES[hue].1[shades[hue] % 3];
        shades[hue] += 1;
        draw_curve(&mut svg, curve, colour);
        let y = TOP + 14.0 + 20.0 * index as f64;
        line(
            &mut svg,
            [RIGHT + 20.0, y - 4.0, RIGHT + 45.0, y - 4.0],
            colour,
            "",
        );
        let name = format!("{} {}", curve.method, curve.parameters);
        text(&mut svg, RIGHT + 52.0, y, "start", &name);
    }
    svg.push_str("</svg>\n");
    svg
}

fn axes(svg: &mut String) {
    for step in 0..=4_u32 {
        let delay_ms = f64::from(step) * 100.0;
        let y = y(delay_ms);
        line(svg, [LEFT, y, RIGHT, y], "#dddddd", "");
        text(svg, LEFT - 8.0, y + 4.0, "end", &format!("{delay_ms}"));
    }
    for (alarms, name) in [
        (0.5, "none"),
        (1.0, "1"),
        (10.0, "10"),
        (100.0, "100"),
        (1e3, "1000"),
        (1e4, "10 000"),
    ] {
        let x = x(alarms);
        line(svg, [x, TOP, x, BOTTOM], "#dddddd", "");
        text(svg, x, BOTTOM + 18.0, "middle", name);
    }
    line(svg, [x(1.0), TOP, x(1.0), BOTTOM], "#888888", "2 3");
    text(
        svg,
        f64::midpoint(LEFT, RIGHT),
        BOTTOM + 40.0,
        "middle",
        "false alarms in 24 h of driving",
    );
    let middle = f64::midpoint(TOP, BOTTOM);
    let _infallible = writeln!(
        svg,
        "<text x=\"20\" y=\"{middle}\" text-anchor=\"middle\" transform=\"rotate(-90 20 {middle})\">\
         detection delay in ms</text>"
    );
}

/// What physics forbids.
fn floor(svg: &mut String, study: &Study) {
    for (quantile, dash, name) in [(0.5, "", "median"), (0.95, "6 4", "95 %")] {
        let delay_ms = quantile_of(&study.floor_ms, quantile);
        if delay_ms > DELAY_MAXIMUM_MS {
            continue;
        }
        let y = y(delay_ms);
        line(svg, [LEFT, y, RIGHT, y], "#000000", dash);
        let name = format!("first count that differs, {name}");
        text(svg, RIGHT + 8.0, y + 4.0, "start", &name);
    }
}

fn draw_curve(svg: &mut String, curve: &Curve, colour: &str) {
    for (quantile, dash) in [(0.5, ""), (0.95, "6 4")] {
        let points = meaningful(curve).iter().map(|point| {
            let alarms = (point.alarms_per_hour * 24.0).clamp(ALARMS_LEAST, ALARMS_MOST);
            (alarms, point.quantile_ms(quantile))
        });
        let seen = points.filter(|(_, delay_ms)| *delay_ms <= DELAY_MAXIMUM_MS);
        let mut path = String::new();
        for (alarms, delay_ms) in seen {
            let _infallible = write!(path, "{:.1},{:.1} ", x(alarms), y(delay_ms));
        }
        let _infallible = writeln!(
            svg,
            "<polyline points=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" \
             stroke-dasharray=\"{dash}\"/>"
        );
    }
}

/// Below the threshold with the most alarms they run into each other, and mean nothing.
fn meaningful(curve: &Curve) -> &[Point] {
    let points = &curve.points;
    let alarms = |index: &usize| points[*index].alarms_per_hour;
    let most = (0..points.len()).max_by(|one, other| alarms(one).total_cmp(&alarms(other)));
    &points[most.unwrap_or_default()..]
}

fn x(alarms: f64) -> f64 {
    let share = (alarms / ALARMS_LEAST).ln() / (ALARMS_MOST / ALARMS_LEAST).ln();
    LEFT + share * (RIGHT - LEFT)
}

fn y(delay_ms: f64) -> f64 {
    BOTTOM - delay_ms / DELAY_MAXIMUM_MS * (BOTTOM - TOP)
}
