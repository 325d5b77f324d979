//! A recorded signal around a fault, with its limits and what was made of it when.

use super::amounts::{at, number, seconds};
use super::markup::{Markup, Pixels};
use super::model::Signal;
use super::scale::{Scale, extent};

/// Size of a plot, and of the part in its middle that has the signal.
const SIZE: [f64; 2] = [720.0, 200.0];
const LEFT: f64 = 64.0;
const RIGHT: f64 = 706.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 168.0;

/// Data outside their limits that are marked one by one.
const MOST_MARKED: usize = 100;

/// A moment that is marked.
#[derive(Debug)]
pub(super) struct Moment {
    pub(super) t_ns: u64,
    /// Class of the line.
    pub(super) class: &'static str,
    pub(super) what: &'static str,
}

/// What is plotted.
#[derive(Debug)]
pub(super) struct Plot<'run> {
    pub(super) signal: &'run Signal,
    /// What is shown of time.
    pub(super) window_ns: (u64, u64),
    pub(super) minimum: Option<f64>,
    pub(super) maximum: Option<f64>,
    pub(super) moments: Vec<Moment>,
}

/// Draws it.
pub(super) fn draw(markup: &mut Markup, plot: &Plot<'_>) {
    let limits = [plot.minimum, plot.maximum];
    let values = plot.signal.samples.iter().map(|(_, value)| *value);
    let extent = extent(values.chain(limits.into_iter().flatten())).unwrap_or([0.0, 1.0]);
    let (from_ns, to_ns) = plot.window_ns;
    let scales = Scales {
        time: Scale::new([seconds(from_ns), seconds(to_ns)], [LEFT, RIGHT]),
        value: Scale::new(extent, [BOTTOM, TOP]),
    };
    let view = format!("0 0 {} {}", SIZE[0], SIZE[1]);
    let label = format!("{} around the fault", plot.signal.name);
    let attributes: [(&str, &dyn std::fmt::Display); 4] = [
        ("viewBox", &view),
        ("class", &"plot"),
        ("role", &"img"),
        ("aria-label", &label),
    ];
    markup.element("svg", &attributes, |svg| {
        frame(svg, &scales);
        for limit in limits.into_iter().flatten() {
            limit_line(svg, &scales, limit);
        }
        for moment in &plot.moments {
            moment_line(svg, &scales, moment);
        }
        for stretch in stretches(&plot.signal.samples, &scales) {
            svg.void("polyline", &[("class", &"signal"), ("points", &stretch)]);
        }
        mark_outside(svg, plot, &scales);
    });
}

struct Scales {
    time: Scale,
    value: Scale,
}

fn frame(svg: &mut Markup, scales: &Scales) {
    for tick in scales.time.ticks(8) {
        let x = Pixels(scales.time.place(tick));
        line(svg, "grid", [x.0, x.0], [TOP, BOTTOM]);
        let y = Pixels(BOTTOM + 16.0);
        svg.leaf(
            "text",
            &[("x", &x), ("y", &y), ("class", &"tick middle")],
            number(tick),
        );
    }
    for tick in scales.value.ticks(5) {
        let y = scales.value.place(tick);
        line(svg, "grid", [LEFT, RIGHT], [y, y]);
        let (x, y) = (Pixels(LEFT - 6.0), Pixels(y + 4.0));
        svg.leaf(
            "text",
            &[("x", &x), ("y", &y), ("class", &"tick end")],
            number(tick),
        );
    }
    let (x, y) = (Pixels(RIGHT), Pixels(BOTTOM + 30.0));
    svg.leaf(
        "text",
        &[("x", &x), ("y", &y), ("class", &"tick end")],
        "time in s",
    );
}

fn limit_line(svg: &mut Markup, scales: &Scales, limit: f64) {
    let y = scales.value.place(limit);
    line(svg, "limit", [LEFT, RIGHT], [y, y]);
    let (x, y) = (Pixels(RIGHT - 4.0), Pixels(y - 3.0));
    let text = format!("limit {}", number(limit));
    svg.leaf(
        "text",
        &[("x", &x), ("y", &y), ("class", &"limit-text end")],
        text,
    );
}

fn moment_line(svg: &mut Markup, scales: &Scales, moment: &Moment) {
    let time_s = seconds(moment.t_ns);
    if scales.time.has(time_s) {
        let x = scales.time.place(time_s);
        svg.element("g", &[], |group| {
            group.leaf(
                "title",
                &[],
                format!("{} at {}", moment.what, at(moment.t_ns)),
            );
            line(group, moment.class, [x, x], [TOP, BOTTOM]);
        });
    }
}

fn line(svg: &mut Markup, class: &str, x: [f64; 2], y: [f64; 2]) {
    let (x1, x2, y1, y2) = (Pixels(x[0]), Pixels(x[1]), Pixels(y[0]), Pixels(y[1]));
    svg.void(
        "line",
        &[
            ("class", &class),
            ("x1", &x1),
            ("x2", &x2),
            ("y1", &y1),
            ("y2", &y2),
        ],
    );
}

/// The signal as points of lines, broken where there is no number. Of each column of pixels only its
/// first, least, greatest and last value are kept: no more can be seen.
fn stretches(samples: &[(u64, f64)], scales: &Scales) -> Vec<String> {
    let mut stretches = vec![String::new()];
    let mut column = Vec::new();
    for (t_ns, value) in samples {
        let x = scales.time.place(seconds(*t_ns));
        let y = scales.value.place(*value);
        let is_new = column
            .first()
            .is_some_and(|(first, _): &(f64, f64)| x - first >= 1.0);
        if is_new || !value.is_finite() {
            write_column(stretches.last_mut(), &mut column);
        }
        match value.is_finite() {
            true => column.push((x, y)),
            false => stretches.push(String::new()),
        }
    }
    write_column(stretches.last_mut(), &mut column);
    stretches.retain(|it| !it.is_empty());
    stretches
}

fn write_column(stretch: Option<&mut String>, column: &mut Vec<(f64, f64)>) {
    let Some(stretch) = stretch else { return };
    let by_height = |one: &&(f64, f64), other: &&(f64, f64)| one.1.total_cmp(&other.1);
    let kept = [
        column.first(),
        column.iter().min_by(by_height),
        column.iter().max_by(by_height),
        column.last(),
    ];
    let count = if column.len() > 4 { 4 } else { 0 };
    let kept: Vec<(f64, f64)> = match count {
        0 => std::mem::take(column),
        _ => kept.into_iter().flatten().copied().collect(),
    };
    for (x, y) in kept {
        *stretch += &format!("{},{} ", Pixels(x), Pixels(y));
    }
    column.clear();
}

/// Marks data outside their limits.
fn mark_outside(svg: &mut Markup, plot: &Plot<'_>, scales: &Scales) {
    let outside = plot.signal.samples.iter().filter(|(_, value)| {
        let too_small = plot.minimum.is_some_and(|least| *value < least);
        too_small || plot.maximum.is_some_and(|most| *value > most)
    });
    for (t_ns, value) in outside.take(MOST_MARKED) {
        let x = Pixels(scales.time.place(seconds(*t_ns)));
        let y = Pixels(scales.value.place(*value));
        svg.void(
            "circle",
            &[("class", &"outside"), ("cx", &x), ("cy", &y), ("r", &2.5)],
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(samples: Vec<(u64, f64)>) -> String {
        let signal = Signal {
            name: "a < b".to_owned(),
            samples,
            left_out: 0,
        };
        let mut markup = Markup::default();
        let plot = Plot {
            signal: &signal,
            window_ns: (0, 1_000_000_000),
            minimum: Some(0.5),
            maximum: None,
            moments: vec![
                Moment {
                    t_ns: 500_000_000,
                    class: "confirmed",
                    what: "confirmed",
                },
                Moment {
                    t_ns: 9_000_000_000,
                    class: "confirmed",
                    what: "confirmed",
                },
            ],
        };
        draw(&mut markup, &plot);
        markup.into_text()
    }

    #[test]
    fn a_signal_is_broken_where_it_is_no_number() {
        for (values, stretches, outside) in [
            (&[1.0, 2.0, 3.0][..], 1, 0),
            (&[1.0, f64::NAN, 0.1], 2, 1),
            (&[f64::NAN, f64::INFINITY], 0, 0),
            (&[0.0, 0.0, 0.0], 1, 3),
        ] {
            let samples = (0..).map(|at| at * 100_000_000).zip(values.iter().copied());
            let svg = drawn(samples.collect());
            assert_eq!(svg.matches("<polyline").count(), stretches, "{values:?}");
            assert_eq!(svg.matches("<circle").count(), outside, "{values:?}");
            assert_eq!(svg.matches("class=\"limit\"").count(), 1);
            assert_eq!(
                svg.matches("class=\"confirmed\"").count(),
                1,
                "only what is shown"
            );
            assert!(svg.contains("a &lt; b"));
        }
    }

    #[test]
    fn many_data_become_as_many_points_as_can_be_seen() {
        let samples = (0..100_000).map(|at| (at * 10_000, f64::from((at % 100) as u32)));
        let svg = drawn(samples.collect());
        let points = svg.matches(',').count();
        assert!((1000..4000).contains(&points), "{points}");
    }
}
