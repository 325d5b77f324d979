//! What stands in the world: arena, walls, obstacles, target.

use std::ops::RangeInclusive;

use system_model::world::{
    ArenaSpecification, ObstacleShape, ObstacleSpecification, RandomObstacleSpecification,
    TargetPlace, TargetSpecification, WallSpecification,
};

use super::quantity::{
    DISTANCE_M, SIZE_M, attribute, colour, heading_rad, interval, measure, place, place_of,
};
use crate::node::Node;

/// More find no place in any arena that is worth driving in.
const OBSTACLE_COUNT: RangeInclusive<usize> = 0..=100;

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
    let reach_distance_m = measure(node, "reach_distance_m", DISTANCE_M);
    node.finish();
    Some(TargetSpecification {
        place: place?,
        radius_m: radius_m?,
        height_m: height_m?,
        colour: colour?,
        reach_distance_m: reach_distance_m?,
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
