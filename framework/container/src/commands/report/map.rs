//! The drive from above, as a component recorded it.

use super::amounts::{at, number};
use super::markup::{Markup, Pixels};
use super::model::Run;
use super::scale::{Scale, extent};

/// The longer side of the way is so long, in pixels, and there is so much room around it.
const SIDE: f64 = 560.0;
const ROOM: f64 = 40.0;

/// Faults that are marked: beyond that they lie on each other.
const MOST_FAULTS: usize = 200;

/// Draws the way of the robot with the faults on it; nothing if none was recorded.
pub(super) fn draw(markup: &mut Markup, run: &Run, anchor: &str) {
    let x = extent(run.path.iter().map(|(_, place)| place[0]));
    let y = extent(run.path.iter().map(|(_, place)| place[1]));
    let (Some(x), Some(y)) = (x, y) else { return };
    // One metre is as long in both directions.
    let (width_m, height_m) = (x[1] - x[0], y[1] - y[0]);
    let metre = SIDE / width_m.max(height_m);
    let (width, height) = (width_m * metre, height_m * metre);
    let scales = [
        Scale::new(x, [ROOM, ROOM + width]),
        Scale::new(y, [ROOM + height, ROOM]),
    ];
    let view = format!("0 0 {:.0} {:.0}", width + 2.0 * ROOM, height + 2.0 * ROOM);
    let attributes: [(&str, &dyn std::fmt::Display); 4] = [
        ("viewBox", &view),
        ("class", &"map"),
        ("role", &"img"),
        ("aria-label", &"the way of the robot"),
    ];
    markup.element("svg", &attributes, |svg| {
        grid(svg, &scales, [width, height]);
        let places = run.path.iter().map(|(_, place)| pixels(place, &scales));
        let points: Vec<String> = places.map(|[x, y]| format!("{x},{y}")).collect();
        svg.void(
            "polyline",
            &[("class", &"way"), ("points", &points.join(" "))],
        );
        for (ends, what) in [(run.path.first(), "start"), (run.path.last(), "end")] {
            if let Some((t_ns, place)) = ends {
                let what = format!("{what} at {}", at(*t_ns));
                dot(svg, place, &scales, ("inside", &what));
            }
        }
        draw_faults(svg, run, &scales, anchor);
    });
}

/// Ticks that have room on an axis so long.
fn most(length: f64) -> usize {
    // From 2 to 8.
    (length / 60.0).clamp(2.0, 8.0) as usize
}

fn grid(svg: &mut Markup, scales: &[Scale; 2], [width, height]: [f64; 2]) {
    let (left, right) = (Pixels(ROOM), Pixels(ROOM + width));
    let (top, bottom) = (Pixels(ROOM), Pixels(ROOM + height));
    for tick in scales[0].ticks(most(width)) {
        let x = Pixels(scales[0].place(tick));
        let y = Pixels(ROOM + height + 16.0);
        svg.void(
            "line",
            &[
                ("class", &"grid"),
                ("x1", &x),
                ("x2", &x),
                ("y1", &top),
                ("y2", &bottom),
            ],
        );
        svg.leaf(
            "text",
            &[("x", &x), ("y", &y), ("class", &"tick middle")],
            format!("{} m", number(tick)),
        );
    }
    for tick in scales[1].ticks(most(height)) {
        let y = Pixels(scales[1].place(tick));
        let (x, baseline) = (Pixels(ROOM - 4.0), Pixels(y.0 + 4.0));
        svg.void(
            "line",
            &[
                ("class", &"grid"),
                ("x1", &left),
                ("x2", &right),
                ("y1", &y),
                ("y2", &y),
            ],
        );
        svg.leaf(
            "text",
            &[("x", &x), ("y", &baseline), ("class", &"tick end")],
            number(tick),
        );
    }
}

fn draw_faults(svg: &mut Markup, run: &Run, scales: &[Scale; 2], anchor: &str) {
    for (fault_number, fault) in run.faults.iter().take(MOST_FAULTS) {
        let verdict = &fault.verdict;
        let Some(place) = place_at(&run.path, verdict.confirmed_ns) else {
            continue;
        };
        let target = format!("#{anchor}-fault-{fault_number}");
        let what = format!(
            "fault {fault_number}: {} of {} at {}",
            verdict.kind.replace('_', " "),
            verdict.component,
            at(verdict.confirmed_ns)
        );
        svg.element("a", &[("href", &target)], |link| {
            dot(link, place, scales, ("outside", &what));
        });
    }
}

/// Where the robot was last known to be at a time; none before the first pose.
fn place_at(path: &[(u64, [f64; 2])], t_ns: u64) -> Option<&[f64; 2]> {
    let behind = path.partition_point(|(pose_ns, _)| *pose_ns <= t_ns);
    path[..behind].last().map(|(_, place)| place)
}

fn pixels(place: &[f64; 2], scales: &[Scale; 2]) -> [Pixels; 2] {
    [
        Pixels(scales[0].place(place[0])),
        Pixels(scales[1].place(place[1])),
    ]
}

fn dot(svg: &mut Markup, place: &[f64; 2], scales: &[Scale; 2], (class, what): (&str, &str)) {
    let [x, y] = pixels(place, scales);
    svg.element("g", &[], |group| {
        group.leaf("title", &[], what);
        group.void(
            "circle",
            &[("class", &class), ("cx", &x), ("cy", &y), ("r", &5)],
        );
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::report::model::{Fault, FaultNumber, Verdict};

    #[test]
    fn a_fault_lies_where_the_robot_was() {
        let path = [(10, [0.0, 0.0]), (20, [1.0, 0.0]), (30, [1.0, 2.0])];
        for (t_ns, expected) in [
            (5, None),
            (10, Some([0.0, 0.0])),
            (29, Some([1.0, 0.0])),
            (99, Some([1.0, 2.0])),
        ] {
            assert_eq!(place_at(&path, t_ns).copied(), expected, "{t_ns}");
        }
    }

    #[test]
    fn there_is_a_map_where_there_is_a_way() {
        let verdict = Verdict {
            confirmed_ns: 20,
            ..Verdict::default()
        };
        let fault = Fault {
            verdict,
            ..Fault::default()
        };
        let mut run = Run {
            faults: [(
                FaultNumber {
                    container: 1,
                    id: 4,
                },
                fault,
            )]
            .into(),
            ..Run::default()
        };
        let mut nothing = Markup::default();
        draw(&mut nothing, &run, "run-1");
        assert_eq!(nothing.into_text(), "");
        run.path = vec![(10, [0.0, 0.0]), (20, [1.0, 0.0]), (30, [1.0, 2.0])];
        let mut markup = Markup::default();
        draw(&mut markup, &run, "run-1");
        let svg = markup.into_text();
        assert!(svg.contains("<a href=\"#run-1-fault-4\">"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 3, "{svg}");
    }
}
