//! What is in the world: arena, walls, obstacles, target, smoke.

use std::ops::RangeInclusive;

use system_model::world::{
    ArenaSpecification, BandSpecification, ObstacleShape, ObstacleSpecification,
    RandomObstacleSpecification, SmokeSpecification, SwaySpecification, TargetPlace,
    TargetSpecification, WallSpecification,
};

use super::quantity::{
    DISTANCE_M, SIZE_M, attribute, colour, heading_rad, interval, measure, place, place_of,
};
use crate::node::Node;

/// More find no place in any arena that is worth driving in.
const OBSTACLE_COUNT: RangeInclusive<usize> = 0..=100;

/// A target that sways faster is a blur in any picture; one that is slower stands.
const SWAY_PERIOD_S: RangeInclusive<f64> = 0.5..=1000.0;
/// A run of a day.
const BEGIN_S: RangeInclusive<f64> = 0.0..=86_400.0;
/// From air that is clear through a hall to smoke in which a hand before the lens is lost.
const SCATTERING_PER_M: RangeInclusive<f64> = 0.001..=100.0;

/// The four outer walls.
pub(super) fn read(node: &Node<'_>) -> Option<ArenaSpecification> {
    let [length_m, width_m, wall_height_m] =
        ["length_m", "width_m", "wall_height_m"].map(|name| measure(node, name, SIZE_M));
    let wall_colour = colour(node, "wall_colour");
    node.finish();
    Some(ArenaSpecification {
        length_m: length_m?,
        width_m: width_m?,
        wall_height_m: wall_height_m?,
        wall_colour: wall_colour?,
    })
}

/// Walls inside the arena.
pub(super) fn walls(root: &Node<'_>, arena: Option<&ArenaSpecification>) -> Vec<WallSpecification> {
    let Some(list) = root.child("walls") else {
        return Vec::new();
    };
    let walls = list.children("wall");
    let walls = walls.iter().filter_map(|node| wall(node, arena)).collect();
    list.finish();
    walls
}

fn wall(node: &Node<'_>, arena: Option<&ArenaSpecification>) -> Option<WallSpecification> {
    let [from, to] = ["from", "to"].map(|end| place_of(node, end, arena));
    let thickness_m = attribute(node, "thickness_m", SIZE_M);
    node.finish();
    Some(WallSpecification {
        from: from?,
        to: to?,
        thickness_m: thickness_m?,
    })
}

/// Obstacles at given places, in document order.
pub(super) fn obstacles(
    root: &Node<'_>,
    arena: Option<&ArenaSpecification>,
) -> Vec<ObstacleSpecification> {
    let Some(list) = root.child("obstacles") else {
        return Vec::new();
    };
    let obstacles = list.children_of(&["circle", "box"]);
    let obstacles = obstacles
        .iter()
        .filter_map(|node| obstacle(node, arena))
        .collect();
    list.finish();
    obstacles
}

fn obstacle(node: &Node<'_>, arena: Option<&ArenaSpecification>) -> Option<ObstacleSpecification> {
    let centre = place(node, arena);
    let shape = match node.name() {
        "circle" => circle(node),
        _ => rectangle(node),
    };
    let height_m = attribute(node, "height_m", SIZE_M);
    let colour = colour(node, "colour");
    node.finish();
    Some(ObstacleSpecification {
        centre: centre?,
        shape: shape?,
        height_m: height_m?,
        colour: colour?,
    })
}

fn circle(node: &Node<'_>) -> Option<ObstacleShape> {
    Some(ObstacleShape::Circle {
        radius_m: attribute(node, "radius_m", SIZE_M)?,
    })
}

fn rectangle(node: &Node<'_>) -> Option<ObstacleShape> {
    let [length_m, width_m] = ["length_m", "width_m"].map(|name| attribute(node, name, SIZE_M));
    let heading_rad = heading_rad(node);
    Some(ObstacleShape::Box {
        length_m: length_m?,
        width_m: width_m?,
        heading_rad: heading_rad?,
    })
}

/// Obstacles that are drawn from the seed of a run.
pub(super) fn random_obstacles(node: &Node<'_>) -> Option<RandomObstacleSpecification> {
    let count = interval(node, "count", ["minimum", "maximum"], &OBSTACLE_COUNT);
    let radius_m = interval(node, "radius", ["minimum_m", "maximum_m"], &SIZE_M);
    let keep_out = node.required_child("keep_out").and_then(|node| {
        let [robot_m, target_m] =
            ["robot_m", "target_m"].map(|name| attribute(&node, name, DISTANCE_M));
        node.finish();
        Some((robot_m?, target_m?))
    });
    let gap_m = measure(node, "gap_m", DISTANCE_M);
    let height_m = measure(node, "height_m", SIZE_M);
    let colour = colour(node, "colour");
    node.finish();
    let (count, radius_m, keep_out) = (count?, radius_m?, keep_out?);
    Some(RandomObstacleSpecification {
        count_minimum: count.0,
        count_maximum: count.1,
        radius_minimum_m: radius_m.0,
        radius_maximum_m: radius_m.1,
        keep_out_robot_m: keep_out.0,
        keep_out_target_m: keep_out.1,
        gap_m: gap_m?,
        height_m: height_m?,
        colour: colour?,
    })
}

/// What the robot looks for.
pub(super) fn target(
    node: &Node<'_>,
    arena: Option<&ArenaSpecification>,
) -> Option<TargetSpecification> {
    let place = target_place(node, arena);
    let radius_m = measure(node, "radius_m", SIZE_M);
    let height_m = measure(node, "height_m", SIZE_M);
    let colour = colour(node, "colour");
    let bands = node.child("bands").map(|node| bands(&node));
    let sway = node.child("sway").map(|node| sway(&node));
    let reach_distance_m = measure(node, "reach_distance_m", DISTANCE_M);
    node.finish();
    Some(TargetSpecification {
        place: place?,
        radius_m: radius_m?,
        height_m: height_m?,
        colour: colour?,
        bands: match bands {
            Some(bands) => Some(bands?),
            None => None,
        },
        sway: match sway {
            Some(sway) => Some(sway?),
            None => None,
        },
        reach_distance_m: reach_distance_m?,
    })
}

fn bands(node: &Node<'_>) -> Option<BandSpecification> {
    let height_m = attribute(node, "height_m", SIZE_M);
    let colour = colour(node, "colour");
    node.finish();
    Some(BandSpecification {
        height_m: height_m?,
        colour: colour?,
    })
}

fn sway(node: &Node<'_>) -> Option<SwaySpecification> {
    let amplitude_m = attribute(node, "amplitude_m", SIZE_M);
    let period_s = attribute(node, "period_s", SWAY_PERIOD_S);
    node.finish();
    Some(SwaySpecification {
        amplitude_m: amplitude_m?,
        period_s: period_s?,
    })
}

/// Smoke that blows in during a run.
pub(super) fn smoke(node: &Node<'_>) -> Option<SmokeSpecification> {
    let begins_s = attribute(node, "begins_s", BEGIN_S);
    let scattering_per_m = attribute(node, "scattering_per_m", SCATTERING_PER_M);
    let airlight = colour(node, "airlight");
    node.finish();
    Some(SmokeSpecification {
        begins_s: begins_s?,
        scattering_per_m: scattering_per_m?,
        airlight: airlight?,
    })
}

fn target_place(node: &Node<'_>, arena: Option<&ArenaSpecification>) -> Option<TargetPlace> {
    let (position, region) = (node.child("position"), node.child("region"));
    match (position, region) {
        (Some(position), None) => {
            let place = place(&position, arena);
            position.finish();
            place.map(TargetPlace::Fixed)
        }
        (None, Some(region)) => target_region(&region, arena),
        (given, _) => {
            let message = match given {
                Some(_) => "<target> has both a <position> and a <region>",
                None => "<target> has neither a <position> nor a <region>",
            };
            let help = "write <position x_m=\"…\" y_m=\"…\"/> for one point, or a <region> to draw \
                        from";
            node.error(message, Some(help.into()));
            None
        }
    }
}

fn target_region(node: &Node<'_>, arena: Option<&ArenaSpecification>) -> Option<TargetPlace> {
    let [lowest, highest] = ["lowest", "highest"].map(|corner| place_of(node, corner, arena));
    node.finish();
    let (lowest, highest) = (lowest?, highest?);
    if lowest.x_m > highest.x_m || lowest.y_m > highest.y_m {
        node.error(
            "the lowest corner is not the lower left one",
            Some("x_m and y_m of <lowest> are at most those of <highest>".into()),
        );
        return None;
    }
    Some(TargetPlace::Region { lowest, highest })
}
