//! A picture of a drive for people: the arena from above.

mod labels;
mod sheet;

use std::time::Duration;

use svg::node::element::{Circle, Group, Polygon, Polyline, Rectangle, Title};
use system_model::world::{Colour, ObstacleShape, Pose, Position};

use crate::Simulation;
use crate::arena::{Solid, SolidKind};
use crate::geometry::compose;
use labels::{axes, legend, text, titles};
use sheet::{PIXELS_PER_M, Sheet, round};

const PATH_COLOUR: &str = "#1f5fbf";
const SENSED_COLOUR: &str = "#e08a00";
const ROBOT_COLOUR: &str = "#12395f";
/// Marks on the path are readable a label's width apart, at full speed and below.
const TIME_MARK_PERIOD: Duration = Duration::from_secs(5);

/// Draws the drive so far as SVG: walls, obstacles and target, what the sonars sensed, the path
/// with a mark every five seconds, the robot at its start and now; axes in m.
pub fn draw_drive(simulation: &Simulation) -> String {
    let world = simulation.world();
    let sheet = Sheet::new(world.arena.length_m, world.arena.width_m);
    let start = world.robot.start;
    let document = svg::Document::new()
        .set("viewBox", (0, 0, round(sheet.width), round(sheet.height)))
        .set("width", round(sheet.width))
        .set("height", round(sheet.height))
        .set("font-family", "sans-serif")
        .set("font-size", 13)
        .add(
            Rectangle::new()
                .set("width", "100%")
                .set("height", "100%")
                .set("fill", "white"),
        )
        .add(titles(simulation, &sheet))
        .add(axes(&sheet))
        .add(solids(simulation, &sheet))
        .add(sensed_points(simulation, &sheet))
        .add(path(simulation, &sheet))
        .add(robot(simulation, &sheet, start, 0.0).add(Title::new("robot at the start")))
        .add(robot(simulation, &sheet, simulation.pose(), 0.85).add(Title::new("robot now")))
        .add(legend(&sheet, world.target.colour));
    document.to_string()
}

fn css(colour: Colour) -> String {
    format!("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue)
}

fn solids(simulation: &Simulation, sheet: &Sheet) -> Group {
    let reach_m = simulation.world().target.radius_m + simulation.world().target.reach_distance_m;
    let (x, y) = sheet.point(simulation.arena().target);
    let reach = Circle::new()
        .set("cx", round(x))
        .set("cy", round(y))
        .set("r", round(reach_m * PIXELS_PER_M))
        .set("fill", "none")
        .set("stroke", css(simulation.world().target.colour))
        .set("stroke-dasharray", "4 3")
        .add(Title::new("reached from here"));
    simulation
        .arena()
        .solids
        .iter()
        .fold(Group::new().add(reach), |group, item| {
            group.add(solid(item, sheet))
        })
}

fn solid(solid: &Solid, sheet: &Sheet) -> Group {
    let (fill, name) = match solid.kind {
        SolidKind::Wall => (labels::WALL_COLOUR.to_owned(), "wall"),
        SolidKind::Obstacle => (css(solid.colour), "obstacle"),
        SolidKind::Target => (css(solid.colour), "target"),
    };
    let centre = solid.outline.centre;
    let group = Group::new().set("fill", fill).add(Title::new(name));
    match solid.outline.shape {
        ObstacleShape::Circle { radius_m } => {
            let (x, y) = sheet.point(centre);
            let radius = round(radius_m * PIXELS_PER_M);
            group.add(
                Circle::new()
                    .set("cx", round(x))
                    .set("cy", round(y))
                    .set("r", radius),
            )
        }
        ObstacleShape::Box {
            length_m,
            width_m,
            heading_rad,
        } => {
            let pose = Pose {
                position: centre,
                heading_rad,
            };
            group.add(rectangle(sheet, pose, length_m, width_m))
        }
    }
}

/// A rectangle around `centre`, its length along the heading.
fn rectangle(sheet: &Sheet, centre: Pose, length_m: f64, width_m: f64) -> Polygon {
    let corners =
        [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)].map(|(along, across)| Position {
            x_m: along * length_m,
            y_m: across * width_m,
        });
    polygon(sheet, centre, &corners)
}

/// A polygon whose corners are given relative to `base`.
fn polygon(sheet: &Sheet, base: Pose, corners: &[Position]) -> Polygon {
    let points = corners.iter().map(|&position| {
        compose(
            base,
            Pose {
                position,
                heading_rad: 0.0,
            },
        )
        .position
    });
    Polygon::new().set("points", sheet.points(points))
}

fn sensed_points(simulation: &Simulation, sheet: &Sheet) -> Group {
    let group = Group::new()
        .set("fill", SENSED_COLOUR)
        .set("fill-opacity", 0.45);
    simulation
        .record()
        .sensed()
        .iter()
        .fold(group, |group, &position| {
            let (x, y) = sheet.point(position);
            group.add(
                Circle::new()
                    .set("cx", round(x))
                    .set("cy", round(y))
                    .set("r", 1.6),
            )
        })
}

fn path(simulation: &Simulation, sheet: &Sheet) -> Group {
    let path = simulation.record().path();
    let line = Polyline::new()
        .set(
            "points",
            sheet.points(path.iter().map(|point| point.position)),
        )
        .set("fill", "none")
        .set("stroke", PATH_COLOUR)
        .set("stroke-width", 2.5)
        .set("stroke-linejoin", "round");
    let marks = path.iter().filter(|point| {
        !point.time.is_zero()
            && point
                .time
                .as_nanos()
                .is_multiple_of(TIME_MARK_PERIOD.as_nanos())
    });
    marks.fold(Group::new().add(line), |group, mark| {
        let (x, y) = sheet.point(mark.position);
        let dot = Circle::new()
            .set("cx", round(x))
            .set("cy", round(y))
            .set("r", 3.5)
            .set("fill", "white")
            .set("stroke", PATH_COLOUR)
            .set("stroke-width", 2);
        let label = text(
            x + 6.0,
            y - 7.0,
            "start",
            &format!("{} s", mark.time.as_secs()),
        )
        .set("fill", PATH_COLOUR)
        .set("font-size", 11)
        .set("stroke", "white")
        .set("stroke-width", 3)
        .set("style", "paint-order: stroke");
        group.add(dot).add(label)
    })
}

/// The robot's body with an arrowhead at its front.
fn robot(simulation: &Simulation, sheet: &Sheet, pose: Pose, opacity: f64) -> Group {
    let robot = &simulation.world().robot;
    let front_m = robot.length_m / 2.0;
    let arrow = [
        Position {
            x_m: front_m,
            y_m: 0.0,
        },
        Position {
            x_m: 0.0,
            y_m: 0.35 * robot.width_m,
        },
        Position {
            x_m: 0.0,
            y_m: -0.35 * robot.width_m,
        },
    ];
    Group::new()
        .add(
            rectangle(sheet, pose, robot.length_m, robot.width_m)
                .set("fill", ROBOT_COLOUR)
                .set("fill-opacity", opacity)
                .set("stroke", ROBOT_COLOUR)
                .set("stroke-width", 1.5),
        )
        .add(
            polygon(sheet, pose, &arrow)
                .set("fill", if opacity > 0.5 { "white" } else { ROBOT_COLOUR }),
        )
}
