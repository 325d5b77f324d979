//! Plane geometry of poses and outlines.

use system_model::world::{ObstacleShape, Pose, Position};

/// Distance between two points in m.
pub(crate) fn distance_m(from: Position, to: Position) -> f64 {
    libm::hypot(to.x_m - from.x_m, to.y_m - from.y_m)
}

/// The point `length_m` away from `from` in the direction `heading_rad`.
pub(crate) fn along(from: Position, heading_rad: f64, length_m: f64) -> Position {
    Position {
        x_m: from.x_m + length_m * libm::cos(heading_rad),
        y_m: from.y_m + length_m * libm::sin(heading_rad),
    }
}

/// A pose given relative to `base`, in the coordinates of `base`'s surroundings.
pub(crate) fn compose(base: Pose, relative: Pose) -> Pose {
    let (sine, cosine) = libm::sincos(base.heading_rad);
    let Position { x_m, y_m } = relative.position;
    Pose {
        position: Position {
            x_m: base.position.x_m + cosine * x_m - sine * y_m,
            y_m: base.position.y_m + sine * x_m + cosine * y_m,
        },
        heading_rad: base.heading_rad + relative.heading_rad,
    }
}

/// The floor that a solid covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    /// Its centre.
    pub centre: Position,
    /// Its shape.
    pub shape: ObstacleShape,
}

impl Outline {
    /// A circle.
    pub(crate) fn circle(centre: Position, radius_m: f64) -> Self {
        Self {
            centre,
            shape: ObstacleShape::Circle { radius_m },
        }
    }

    /// Distance in m from a point to the outline; negative inside.
    pub fn distance_m(&self, point: Position) -> f64 {
        match self.shape {
            ObstacleShape::Circle { radius_m } => distance_m(self.centre, point) - radius_m,
            ObstacleShape::Box {
                length_m,
                width_m,
                heading_rad,
            } => {
                let (sine, cosine) = libm::sincos(heading_rad);
                let (dx, dy) = (point.x_m - self.centre.x_m, point.y_m - self.centre.y_m);
                let beyond_x = (cosine * dx + sine * dy).abs() - length_m / 2.0;
                let beyond_y = (cosine * dy - sine * dx).abs() - width_m / 2.0;
                libm::hypot(beyond_x.max(0.0), beyond_y.max(0.0)) + beyond_x.max(beyond_y).min(0.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn distance_to_an_outline_is_negative_inside() {
        let centre = Position { x_m: 1.0, y_m: 2.0 };
        let lying = ObstacleShape::Box {
            length_m: 0.4,
            width_m: 0.2,
            heading_rad: 0.0,
        };
        let standing = ObstacleShape::Box {
            length_m: 0.4,
            width_m: 0.2,
            heading_rad: FRAC_PI_2,
        };
        let round = ObstacleShape::Circle { radius_m: 0.5 };
        let cases = [
            (lying, 1.0, 2.0, -0.1),
            (lying, 1.5, 2.0, 0.3),
            (lying, 1.5, 2.5, 0.5),
            (standing, 1.5, 2.0, 0.4),
            (standing, 1.0, 2.5, 0.3),
            (round, 1.0, 2.2, -0.3),
            (round, 2.0, 2.0, 0.5),
        ];
        for (shape, x_m, y_m, expected) in cases {
            let distance_m = Outline { centre, shape }.distance_m(Position { x_m, y_m });
            assert!(
                (distance_m - expected).abs() < 1e-12,
                "{shape:?} {x_m} {y_m}: {distance_m}"
            );
        }
    }
}
