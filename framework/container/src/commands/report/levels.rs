//! What can be drawn of a verdict alone: a quantity between its limits, and votes.

use super::amounts::number;
use super::evidence::{Drawing, Level};
use super::markup::{Markup, Pixels};
use super::scale::{Scale, extent};

/// Size, and where the axis lies.
const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 64.0;
const LEFT: f64 = 20.0;
const RIGHT: f64 = 700.0;
const AXIS: f64 = 34.0;

/// Draws it; nothing if there is no number in it.
pub(super) fn draw(markup: &mut Markup, drawing: &Drawing) {
    match drawing {
        Drawing::Level(level) => draw_level(markup, level),
        Drawing::Votes {
            votes,
            dissent,
            voted,
            tolerance,
        } => {
            let allowed = [voted - tolerance, voted + tolerance];
            let said = votes.iter().flatten().copied();
            let all = said.chain([*dissent, *voted]).chain(allowed);
            let Some(extent) = extent(all) else { return };
            axis(markup, "votes of the sources", extent, |svg, scale| {
                band(svg, scale, allowed);
                for vote in votes.iter().flatten().filter(|it| it.is_finite()) {
                    let is_outside = (vote - voted).abs() > *tolerance;
                    let class = if is_outside { "outside" } else { "inside" };
                    point(
                        svg,
                        scale,
                        *vote,
                        class,
                        &format!("a source said {}", number(*vote)),
                    );
                }
                word(svg, scale, *voted, &format!("voted {}", number(*voted)));
                if dissent.is_finite() && (dissent - voted).abs() > *tolerance {
                    word(
                        svg,
                        scale,
                        *dissent,
                        &format!("it said {}", number(*dissent)),
                    );
                }
            });
        }
    }
}

fn draw_level(markup: &mut Markup, level: &Level) {
    if !level.value.is_finite() {
        return;
    }
    let limits = [level.minimum, level.maximum];
    // A limit from above alone is one of a quantity that begins at nought.
    let nought = (level.minimum.is_none() && level.value >= 0.0).then_some(0.0);
    let all = limits
        .into_iter()
        .chain([Some(level.value), nought])
        .flatten();
    let Some(extent) = extent(all) else { return };
    axis(markup, &level.quantity, extent, |svg, scale| {
        let least = level.minimum.unwrap_or(extent[0]);
        band(svg, scale, [least, level.maximum.unwrap_or(extent[1])]);
        for limit in limits.into_iter().flatten() {
            word(svg, scale, limit, &format!("limit {}", number(limit)));
        }
        let is_outside = level.minimum.is_some_and(|least| level.value < least)
            || level.maximum.is_some_and(|most| level.value > most);
        let class = if is_outside { "outside" } else { "inside" };
        let what = format!("{} {}", level.quantity, number(level.value));
        point(svg, scale, level.value, class, &what);
        let (x, y) = (Pixels(scale.place(level.value)), Pixels(AXIS - 12.0));
        let text = number(level.value);
        svg.leaf(
            "text",
            &[("x", &x), ("y", &y), ("class", &"value middle")],
            text,
        );
    });
}

fn axis(
    markup: &mut Markup,
    label: &str,
    extent: [f64; 2],
    content: impl FnOnce(&mut Markup, &Scale),
) {
    let scale = Scale::new(extent, [LEFT, RIGHT]);
    let view = format!("0 0 {WIDTH} {HEIGHT}");
    let attributes: [(&str, &dyn std::fmt::Display); 4] = [
        ("viewBox", &view),
        ("class", &"plot level"),
        ("role", &"img"),
        ("aria-label", &label),
    ];
    markup.element("svg", &attributes, |svg| {
        let (left, right, y) = (Pixels(LEFT), Pixels(RIGHT), Pixels(AXIS));
        let ends: [(&str, &dyn std::fmt::Display); 5] = [
            ("class", &"axis"),
            ("x1", &left),
            ("x2", &right),
            ("y1", &y),
            ("y2", &y),
        ];
        svg.void("line", &ends);
        let top = Pixels(10.0);
        svg.leaf(
            "text",
            &[("x", &left), ("y", &top), ("class", &"tick")],
            label,
        );
        content(svg, &scale);
    });
}

/// What is allowed.
fn band(svg: &mut Markup, scale: &Scale, [from, to]: [f64; 2]) {
    let (from, to) = (scale.place(from), scale.place(to));
    let (x, width) = (Pixels(from), Pixels((to - from).max(1.0)));
    let (y, height) = (Pixels(AXIS - 6.0), Pixels(12.0));
    svg.void(
        "rect",
        &[
            ("class", &"allowed"),
            ("x", &x),
            ("y", &y),
            ("width", &width),
            ("height", &height),
        ],
    );
}

fn point(svg: &mut Markup, scale: &Scale, value: f64, class: &str, what: &str) {
    let (x, y) = (Pixels(scale.place(value)), Pixels(AXIS));
    svg.element("g", &[], |group| {
        group.leaf("title", &[], what);
        group.void(
            "circle",
            &[("class", &class), ("cx", &x), ("cy", &y), ("r", &5)],
        );
    });
}

/// A quantity in words below the axis, kept inside the drawing.
fn word(svg: &mut Markup, scale: &Scale, value: f64, text: &str) {
    let place = scale.place(value);
    let class = match place {
        _ if place < LEFT + 60.0 => "tick",
        _ if place > RIGHT - 60.0 => "tick end",
        _ => "tick middle",
    };
    let (x, y) = (Pixels(place), Pixels(AXIS + 22.0));
    svg.leaf("text", &[("x", &x), ("y", &y), ("class", &class)], text);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(drawing: &Drawing) -> String {
        let mut markup = Markup::default();
        draw(&mut markup, drawing);
        markup.into_text()
    }

    #[test]
    fn a_level_is_inside_its_limits_or_not() {
        let level = |value, minimum, maximum| {
            drawn(&Drawing::Level(Level {
                quantity: "distance".to_owned(),
                value,
                minimum,
                maximum,
            }))
        };
        for (value, minimum, maximum, class) in [
            (0.0, Some(0.03), Some(3.0), "outside"),
            (1.0, Some(0.03), Some(3.0), "inside"),
            (4.0, None, Some(3.0), "outside"),
            (-4.0, Some(-3.0), None, "outside"),
        ] {
            let svg = level(value, minimum, maximum);
            assert!(svg.contains(&format!("<circle class=\"{class}\"")), "{svg}");
            assert!(svg.contains("class=\"allowed\""), "{svg}");
        }
        assert_eq!(level(f64::NAN, Some(0.0), Some(1.0)), "");
    }

    #[test]
    fn each_vote_is_a_point() {
        let svg = drawn(&Drawing::Votes {
            votes: vec![Some(1.7), Some(2.2), None, Some(f64::NAN), Some(1.75)],
            dissent: 2.2,
            voted: 1.7,
            tolerance: 0.1,
        });
        assert_eq!(svg.matches("<circle class=\"inside\"").count(), 2, "{svg}");
        assert_eq!(svg.matches("<circle class=\"outside\"").count(), 1, "{svg}");
        assert!(
            svg.contains("voted 1.7") && svg.contains("it said 2.2"),
            "{svg}"
        );
    }
}
