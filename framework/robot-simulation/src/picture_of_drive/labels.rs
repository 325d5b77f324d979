//! Title, axes and legend.

use svg::node::element::{Circle, Group, Line, Rectangle, Text};
use system_model::world::{Colour, Position};

use super::sheet::{LEFT, PIXELS_PER_M, Sheet, TOP, round};
use super::{PATH_COLOUR, ROBOT_COLOUR, SENSED_COLOUR, css};
use crate::Simulation;

/// One line every half metre.
const GRID_LINES_PER_M: f64 = 2.0;
pub(super) const WALL_COLOUR: &str = "#5b5f66";
const OBSTACLE_COLOUR: &str = "#766854";

pub(super) fn text(x: f64, y: f64, anchor: &str, content: &str) -> Text {
    Text::new(content)
        .set("x", round(x))
        .set("y", round(y))
        .set("text-anchor", anchor)
}

pub(super) fn titles(simulation: &Simulation, sheet: &Sheet) -> Group {
    let summary = simulation.summary();
    let result = match summary.time_s {
        Some(time_s) => format!("target reached after {time_s:.1} s"),
        None => format!(
            "target not reached in {:.1} s",
            simulation.time().as_secs_f64()
        ),
    };
    let contacts = match summary.collisions {
        0 => "nothing touched".to_owned(),
        1 => "1 collision".to_owned(),
        count => format!("{count} collisions"),
    };
    let title = format!(
        "World {}, seed {}: {result}",
        simulation.world().name,
        simulation.seed()
    );
    let details = format!(
        "path {:.2} m, least clearance {:.2} m, {contacts}, {:.2} m from the target at {:.1} s",
        summary.path_length_m,
        summary.least_clearance_m,
        summary.distance_to_target_m,
        simulation.time().as_secs_f64(),
    );
    let middle = LEFT + sheet.length_m * PIXELS_PER_M / 2.0;
    Group::new()
        .add(
            text(middle, 32.0, "middle", &title)
                .set("font-size", 19)
                .set("font-weight", "bold"),
        )
        .add(text(middle, 56.0, "middle", &details).set("fill", "#444"))
}

/// Grid, numbers at whole metres, names.
pub(super) fn axes(sheet: &Sheet) -> Group {
    let (left, right) = (LEFT, LEFT + sheet.length_m * PIXELS_PER_M);
    let (top, bottom) = (TOP, TOP + sheet.width_m * PIXELS_PER_M);
    let floor = Rectangle::new()
        .set("x", left)
        .set("y", top)
        .set("width", round(right - left))
        .set("height", round(bottom - top))
        .set("fill", "#f6f7f9");
    let mut group = Group::new().set("fill", "#333").add(floor);
    for (place_m, is_whole) in grid(sheet.length_m) {
        let x = LEFT + place_m * PIXELS_PER_M;
        group = group.add(grid_line((x, top), (x, bottom), is_whole));
        if is_whole {
            group = group.add(text(x, bottom + 48.0, "middle", &format!("{place_m:.0}")));
        }
    }
    for (place_m, is_whole) in grid(sheet.width_m) {
        let y = bottom - place_m * PIXELS_PER_M;
        group = group.add(grid_line((left, y), (right, y), is_whole));
        if is_whole {
            group = group.add(text(left - 38.0, y + 4.5, "end", &format!("{place_m:.0}")));
        }
    }
    let middle = (top + bottom) / 2.0;
    let upright = text(18.0, middle, "middle", "y in m")
        .set("transform", format!("rotate(-90 18 {})", round(middle)));
    group
        .add(text(
            (left + right) / 2.0,
            bottom + 68.0,
            "middle",
            "x in m",
        ))
        .add(upright)
}

/// Places of grid lines along an axis, and whether each stands at a whole metre.
fn grid(size_m: f64) -> impl Iterator<Item = (f64, bool)> {
    let lines = (size_m * GRID_LINES_PER_M) as u32;
    (0..=lines).map(|line| {
        let place_m = f64::from(line) / GRID_LINES_PER_M;
        (place_m, place_m.fract() == 0.0)
    })
}

fn grid_line(from: (f64, f64), to: (f64, f64), is_whole: bool) -> Line {
    Line::new()
        .set("x1", round(from.0))
        .set("y1", round(from.1))
        .set("x2", round(to.0))
        .set("y2", round(to.1))
        .set("stroke", if is_whole { "#d3d7dd" } else { "#e6e9ed" })
}

/// One row under the map.
pub(super) fn legend(sheet: &Sheet, target: Colour) -> Group {
    let corner = sheet.point(Position { x_m: 0.0, y_m: 0.0 });
    let y = corner.1 + 98.0;
    let round_mark = |x: f64, radius: f64, colour: &str| {
        let circle = Circle::new().set("cx", x).set("cy", y).set("r", radius);
        Group::new().add(circle.set("fill", colour))
    };
    let square_mark = |x: f64, opacity: f64, colour: &str| {
        let square = Rectangle::new()
            .set("x", x - 10.0)
            .set("y", y - 6.0)
            .set("width", 20)
            .set("height", 12)
            .set("fill", colour)
            .set("fill-opacity", opacity)
            .set("stroke", colour);
        Group::new().add(square)
    };
    let line_mark = |x: f64| {
        let line = Line::new()
            .set("x1", x - 12.0)
            .set("x2", x + 12.0)
            .set("y1", y)
            .set("y2", y);
        Group::new().add(line.set("stroke", PATH_COLOUR).set("stroke-width", 2.5))
    };
    let step = (sheet.length_m * PIXELS_PER_M / 7.0).max(100.0);
    let place = |index: f64| corner.0 + index * step;
    let entries = [
        (square_mark(place(0.0), 0.0, ROBOT_COLOUR), "start"),
        (square_mark(place(1.0), 0.85, ROBOT_COLOUR), "robot now"),
        (line_mark(place(2.0)), "path"),
        (round_mark(place(3.0), 3.0, SENSED_COLOUR), "sonar echo"),
        (round_mark(place(4.0), 8.0, OBSTACLE_COLOUR), "obstacle"),
        (round_mark(place(5.0), 8.0, &css(target)), "target"),
        (square_mark(place(6.0), 1.0, WALL_COLOUR), "wall"),
    ];
    let mut group = Group::new();
    for (index, (mark, name)) in entries.into_iter().enumerate() {
        group = group
            .add(mark)
            .add(text(place(index as f64) + 18.0, y + 4.5, "start", name));
    }
    group
}
