//! Measures within bounds, and the small things that are made of them.

use std::fmt::Display;
use std::ops::RangeInclusive;

use system_model::world::{ArenaSpecification, Colour, Pose, Position};

use crate::node::Node;
use crate::suggest::quoted;
use crate::value::{Number, Value};

/// Sizes of things: from a millimetre, below which the physics has no meaning, to a large hall.
pub(super) const SIZE_M: RangeInclusive<f64> = 0.001..=100.0;
/// Distances that may vanish.
pub(super) const DISTANCE_M: RangeInclusive<f64> = 0.0..=100.0;
const COORDINATE_M: RangeInclusive<f64> = -100.0..=100.0;
const HEADING_DEG: RangeInclusive<f64> = -360.0..=360.0;

/// The number in a mandatory child.
pub(super) fn measure<T>(node: &Node<'_>, name: &'static str, range: RangeInclusive<T>) -> Option<T>
where
    T: Number + PartialOrd + Display,
{
    within(&node.required_value(name)?, &range)
}

/// The number in a mandatory attribute.
pub(in crate::readers) fn attribute<T>(
    node: &Node<'_>,
    name: &'static str,
    range: RangeInclusive<T>,
) -> Option<T>
where
    T: Number + PartialOrd + Display,
{
    within(&node.required_attribute(name)?, &range)
}

pub(in crate::readers) fn within<T>(value: &Value<'_>, range: &RangeInclusive<T>) -> Option<T>
where
    T: Number + PartialOrd + Display,
{
    let number: T = value.number()?;
    if range.contains(&number) {
        return Some(number);
    }
    let (lowest, highest) = (range.start(), range.end());
    let message = format!(
        "`{}` in {} is out of range",
        quoted(value.as_str()),
        value.owner()
    );
    value.error(
        message,
        Some(format!("write a number from {lowest} to {highest}")),
    );
    None
}

/// Two mandatory attributes of a mandatory child, of which the first is not the larger one.
pub(super) fn interval<T>(
    node: &Node<'_>,
    name: &'static str,
    ends: [&'static str; 2],
    range: &RangeInclusive<T>,
) -> Option<(T, T)>
where
    T: Number + PartialOrd + Display + Clone,
{
    let child = node.required_child(name)?;
    let [minimum, maximum] = ends.map(|end| attribute(&child, end, range.clone()));
    child.finish();
    let (minimum, maximum) = (minimum?, maximum?);
    if minimum > maximum {
        child.error(
            "the minimum is larger than the maximum",
            Some(format!("exchange {minimum} and {maximum}")),
        );
        return None;
    }
    Some((minimum, maximum))
}

/// The attributes `x_m` and `y_m`.
pub(super) fn position(node: &Node<'_>) -> Option<Position> {
    let [x_m, y_m] = ["x_m", "y_m"].map(|name| attribute(node, name, COORDINATE_M));
    Some(Position {
        x_m: x_m?,
        y_m: y_m?,
    })
}

/// A point that is not outside of the arena, if that one is known.
pub(super) fn place(node: &Node<'_>, arena: Option<&ArenaSpecification>) -> Option<Position> {
    let position = position(node)?;
    let is_inside = |arena: &ArenaSpecification| {
        (0.0..=arena.length_m).contains(&position.x_m)
            && (0.0..=arena.width_m).contains(&position.y_m)
    };
    match arena {
        Some(arena) if !is_inside(arena) => {
            let help = format!(
                "x_m goes from 0 to {}, y_m from 0 to {}",
                arena.length_m, arena.width_m
            );
            node.error("this place is not in the arena", Some(help));
            None
        }
        _ => Some(position),
    }
}

/// A mandatory child that is a point in the arena.
pub(super) fn place_of(
    node: &Node<'_>,
    name: &'static str,
    arena: Option<&ArenaSpecification>,
) -> Option<Position> {
    let child = node.required_child(name)?;
    let place = place(&child, arena);
    child.finish();
    place
}

/// The attribute `heading_deg`, in radians.
pub(super) fn heading_rad(node: &Node<'_>) -> Option<f64> {
    attribute(node, "heading_deg", HEADING_DEG).map(f64::to_radians)
}

/// The mandatory child `mount`.
pub(super) fn mount(node: &Node<'_>) -> Option<Pose> {
    let child = node.required_child("mount")?;
    let (position, heading_rad) = (position(&child), heading_rad(&child));
    child.finish();
    Some(Pose {
        position: position?,
        heading_rad: heading_rad?,
    })
}

/// A mandatory child with the attributes `red`, `green` and `blue`.
pub(super) fn colour(node: &Node<'_>, name: &'static str) -> Option<Colour> {
    let child = node.required_child(name)?;
    let [red, green, blue] =
        ["red", "green", "blue"].map(|channel| attribute(&child, channel, 0..=u8::MAX));
    child.finish();
    Some(Colour {
        red: red?,
        green: green?,
        blue: blue?,
    })
}
