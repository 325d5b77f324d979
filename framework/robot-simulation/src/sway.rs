//! A target that sways to and fro.

use std::f64::consts::TAU;
use std::time::Duration;

use system_model::world::{Position, SwaySpecification};

/// Where a target is at `time` that sways around `middle`.
pub(crate) fn place(sway: SwaySpecification, middle: Position, time: Duration) -> Position {
    let away_m = sway.amplitude_m * libm::sin(TAU * time.as_secs_f64() / sway.period_s);
    Position {
        y_m: middle.y_m + away_m,
        ..middle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_farthest_after_a_quarter_and_three_quarters_of_its_period() {
        let sway = SwaySpecification {
            amplitude_m: 0.5,
            period_s: 8.0,
        };
        let middle = Position { x_m: 2.0, y_m: 1.0 };
        for (time_s, y_m) in [(0, 1.0), (2, 1.5), (4, 1.0), (6, 0.5), (8, 1.0)] {
            let found = place(sway, middle, Duration::from_secs(time_s));
            assert!((found.y_m - y_m).abs() < 1e-9, "{time_s} s: {found:?}");
            assert_eq!(found.x_m, 2.0);
        }
    }
}
