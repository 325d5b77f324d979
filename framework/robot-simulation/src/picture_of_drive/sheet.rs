//! Where a point of the arena lies on the sheet.

use system_model::world::Position;

/// A room of 6 m by 4 m then fits a laptop's screen.
pub(super) const PIXELS_PER_M: f64 = 150.0;
/// Room for the outer walls (0.2 m) and the numbers of the axes.
pub(super) const LEFT: f64 = 84.0;
const RIGHT: f64 = 50.0;
pub(super) const TOP: f64 = 106.0;
/// Also room for the legend.
const BOTTOM: f64 = 122.0;

/// A map with the same scale both ways, y upwards.
pub(super) struct Sheet {
    pub(super) length_m: f64,
    pub(super) width_m: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Sheet {
    pub(super) fn new(length_m: f64, width_m: f64) -> Self {
        Self {
            length_m,
            width_m,
            width: LEFT + length_m * PIXELS_PER_M + RIGHT,
            height: TOP + width_m * PIXELS_PER_M + BOTTOM,
        }
    }

    pub(super) fn point(&self, position: Position) -> (f64, f64) {
        (
            LEFT + position.x_m * PIXELS_PER_M,
            TOP + (self.width_m - position.y_m) * PIXELS_PER_M,
        )
    }

    pub(super) fn points(&self, positions: impl Iterator<Item = Position>) -> String {
        let points: Vec<String> = positions
            .map(|position| {
                let (x, y) = self.point(position);
                format!("{},{}", round(x), round(y))
            })
            .collect();
        points.join(" ")
    }
}

/// To a tenth of a pixel: finer is only longer.
pub(super) fn round(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}
