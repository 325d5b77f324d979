//! Who was in which state when, with faults and recoveries marked.

mod marks;
mod spans;

use std::collections::BTreeSet;

use super::amounts::{at, number, seconds};
use super::markup::{Markup, Pixels};
use super::model::Run;
use super::scale::Scale;
use marks::{Mark, marks, merged};
use spans::{Span, spans};

/// Where the names end and time begins, and where it ends.
const LEFT: f64 = 200.0;
const RIGHT: f64 = 980.0;
const WIDTH: f64 = 1000.0;

/// Height of a component's row, of the bar in it, and of what is above all rows.
const ROW: f64 = 22.0;
const BAR: f64 = 12.0;
const HEAD: f64 = 24.0;

/// Components that have a row; those with faults come before others then.
const MOST_ROWS: usize = 120;

/// Letters of a name that have room.
const MOST_LETTERS: usize = 28;

/// Draws it. `anchor` is what references to faults of the run begin with.
pub(super) fn draw(markup: &mut Markup, run: &Run, anchor: &str) {
    let Some((from_ns, to_ns)) = run.span_ns else {
        return;
    };
    let (rows, left_out) = rows(run);
    let time = Scale::new([seconds(from_ns), seconds(to_ns)], [LEFT, RIGHT]);
    let height = HEAD + ROW * rows.len() as f64 + 24.0;
    let view = format!("0 0 {WIDTH} {height}");
    let attributes: [(&str, &dyn std::fmt::Display); 4] = [
        ("viewBox", &view),
        ("class", &"timeline"),
        ("role", &"img"),
        ("aria-label", &"states of the components over time"),
    ];
    markup.element("svg", &attributes, |svg| {
        grid(svg, &time, height - 24.0);
        draw_incidents(svg, run, &time, height - 24.0);
        for (index, component) in rows.iter().enumerate() {
            let top = HEAD + ROW * index as f64;
            draw_row(svg, run, component, top, (&time, anchor));
        }
    });
    if left_out > 0 {
        let text = format!("{left_out} more components without a fault are not drawn.");
        markup.leaf("p", &[("class", &"note")], text);
    }
}

/// Components that get a row, by name; and how many get none.
fn rows(run: &Run) -> (Vec<&str>, usize) {
    let faulty = run.faults.values().map(|it| it.verdict.component.as_str());
    let faulty: BTreeSet<&str> = faulty.collect();
    let others = run.states.keys().map(String::as_str);
    let others = others.filter(|it| !faulty.contains(it));
    let all: Vec<&str> = faulty.iter().copied().chain(others).collect();
    let left_out = all.len().saturating_sub(MOST_ROWS);
    let mut rows: Vec<&str> = all.into_iter().take(MOST_ROWS).collect();
    rows.sort_unstable();
    (rows, left_out)
}

fn grid(svg: &mut Markup, time: &Scale, bottom: f64) {
    for tick in time.ticks(10) {
        let (x, y1, y2) = (Pixels(time.place(tick)), Pixels(HEAD - 6.0), Pixels(bottom));
        svg.void(
            "line",
            &[
                ("class", &"grid"),
                ("x1", &x),
                ("x2", &x),
                ("y1", &y1),
                ("y2", &y2),
            ],
        );
        let y = Pixels(bottom + 16.0);
        let text = format!("{} s", number(tick));
        svg.leaf(
            "text",
            &[("x", &x), ("y", &y), ("class", &"tick middle")],
            text,
        );
    }
}

/// What concerns the whole run: lines from top to bottom, and what was made on purpose.
fn draw_incidents(svg: &mut Markup, run: &Run, time: &Scale, bottom: f64) {
    let places = run.incidents.iter().filter_map(|incident| {
        let class = match incident.kind.as_str() {
            "injection" => "injected",
            "container_restarted" | "container_given_up" => "restarted",
            _ => return None,
        };
        let text = format!("{} at {}", incident.text, at(incident.t_ns));
        Some(Mark {
            x: time.place(seconds(incident.t_ns)),
            class,
            what: text,
            target: None,
        })
    });
    for mark in merged(places.collect()) {
        let (x, y1, y2) = (Pixels(mark.x), Pixels(HEAD - 12.0), Pixels(bottom));
        svg.element("g", &[], |group| {
            group.leaf("title", &[], &mark.what);
            let ends: [(&str, &dyn std::fmt::Display); 5] = [
                ("class", &mark.class),
                ("x1", &x),
                ("x2", &x),
                ("y1", &y1),
                ("y2", &y2),
            ];
            group.void("line", &ends);
            group.void(
                "circle",
                &[("class", &mark.class), ("cx", &x), ("cy", &y1), ("r", &4)],
            );
        });
    }
}

fn draw_row(
    svg: &mut Markup,
    run: &Run,
    component: &str,
    top: f64,
    (time, anchor): (&Scale, &str),
) {
    let (x, y) = (Pixels(LEFT - 8.0), Pixels(top + BAR));
    svg.element(
        "text",
        &[("x", &x), ("y", &y), ("class", &"name end")],
        |text| {
            text.leaf("title", &[], component);
            text.text(shortened(component));
        },
    );
    let changes = run.states.get(component).map(Vec::as_slice);
    let end_ns = run.span_ns.map_or(0, |(_, end_ns)| end_ns);
    for Span {
        x,
        width,
        state,
        what,
    } in spans(changes.unwrap_or_default(), end_ns, time)
    {
        let (x, y, width) = (Pixels(x), Pixels(top + 2.0), Pixels(width));
        let class = format!("state {state}");
        svg.element("g", &[], |group| {
            group.leaf("title", &[], format!("{component}: {what}"));
            let sides: [(&str, &dyn std::fmt::Display); 5] = [
                ("class", &class),
                ("x", &x),
                ("y", &y),
                ("width", &width),
                ("height", &BAR),
            ];
            group.void("rect", &sides);
        });
    }
    for mark in merged(marks(run, component, time, anchor)) {
        draw_mark(svg, &mark, top);
    }
}

/// A fault is a triangle on the bar, a recovery one below it.
fn draw_mark(svg: &mut Markup, mark: &Mark, top: f64) {
    let (tip, base) = match mark.class {
        "recovered" => (top + BAR - 1.0, top + BAR + 7.0),
        _ => (top + 5.0, top - 4.0),
    };
    let [left, right] = [mark.x - 4.5, mark.x + 4.5].map(Pixels);
    let (x, tip, base) = (Pixels(mark.x), Pixels(tip), Pixels(base));
    let points = format!("{x},{tip} {left},{base} {right},{base}");
    let shape = |group: &mut Markup| {
        group.leaf("title", &[], &mark.what);
        group.void("polygon", &[("class", &mark.class), ("points", &points)]);
    };
    match &mark.target {
        Some(target) => svg.element("a", &[("href", target)], shape),
        None => svg.element("g", &[], shape),
    }
}

/// A name that has room: its end tells more than its beginning, which is the application's.
fn shortened(name: &str) -> String {
    let letters = name.chars().count();
    match letters > MOST_LETTERS {
        true => name
            .chars()
            .skip(letters - MOST_LETTERS + 1)
            .fold("…".to_owned(), |text, it| text + &it.to_string()),
        false => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::report::model::{Fault, FaultNumber, StateChange, Verdict};

    fn run(components: usize, faulty: &str) -> Run {
        let change = StateChange {
            t_ns: 0,
            from: "READY".to_owned(),
            to: "ACTIVE".to_owned(),
            incarnation: 1,
        };
        let names = (0..components).map(|number| format!("relay_{number:04}"));
        let verdict = Verdict {
            component: faulty.to_owned(),
            ..Verdict::default()
        };
        let fault = Fault {
            verdict,
            ..Fault::default()
        };
        Run {
            span_ns: Some((0, 1_000_000_000)),
            states: names.map(|name| (name, vec![change.clone()])).collect(),
            faults: [(
                FaultNumber {
                    container: 1,
                    id: 1,
                },
                fault,
            )]
            .into(),
            ..Run::default()
        }
    }

    #[test]
    fn rows_have_a_bound_and_faulty_components_one() {
        for (components, drawn, left_out) in [(2, 2, 0), (500, MOST_ROWS, 500 - MOST_ROWS)] {
            let faulty = format!("relay_{:04}", components - 1);
            let run = run(components, &faulty);
            let (rows, rest) = rows(&run);
            assert_eq!((rows.len(), rest), (drawn, left_out));
            assert!(rows.contains(&faulty.as_str()));
            assert!(rows.is_sorted());
        }
    }

    #[test]
    fn a_fault_of_a_component_that_never_started_has_a_row() {
        let mut markup = Markup::default();
        draw(&mut markup, &run(1, "camera"), "run-1");
        let svg = markup.into_text();
        assert!(svg.contains("href=\"#run-1-fault-1\""), "{svg}");
        assert_eq!(svg.matches("class=\"name end\"").count(), 2, "{svg}");
    }

    #[test]
    fn long_names_are_shortened() {
        assert_eq!(shortened("camera"), "camera");
        let long = "target_following/obstacle_avoidance";
        assert_eq!(shortened(long).chars().count(), MOST_LETTERS);
        assert!(shortened(long).ends_with("/obstacle_avoidance"));
    }
}
