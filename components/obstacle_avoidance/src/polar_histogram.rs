//! How far the robot can go in each direction.
//!
//! After the vector field histogram of Borenstein and Koren (1991), with distances in place of
//! certainties: every echo, widened by what the robot needs beside it, shortens the directions that
//! it covers.

use crate::echo_map::Sighting;

/// 5 degrees each: finer than a sonar can tell.
const DIRECTIONS: usize = 72;
const DIRECTION_DEG: f64 = 360.0 / DIRECTIONS as f64;

/// Echoes farther than this from the robot's centre do not matter.
pub const WINDOW_M: f64 = 0.75;
/// Between the robot's centre line and an echo beside it: half the width of the robot, and 9 cm.
const SIDE_CLEARANCE_M: f64 = 0.16;

/// Free ways around the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolarHistogram {
    free_m: [f64; DIRECTIONS],
}

impl PolarHistogram {
    /// The free ways between these echoes.
    pub fn new(sightings: impl Iterator<Item = Sighting>) -> Self {
        let mut free_m = [WINDOW_M; DIRECTIONS];
        for sighting in sightings.filter(|sighting| sighting.distance_m < WINDOW_M) {
            let sine = (SIDE_CLEARANCE_M / sighting.distance_m).min(1.0);
            let half_width_deg = sine.asin().to_degrees();
            let bearing_deg = sighting.bearing_rad.to_degrees();
            for (index, free_m) in free_m.iter_mut().enumerate() {
                let off_deg = (index as f64 * DIRECTION_DEG - bearing_deg).rem_euclid(360.0);
                if off_deg.min(360.0 - off_deg) <= half_width_deg {
                    *free_m = free_m.min(sighting.distance_m);
                }
            }
        }
        Self { free_m }
    }

    /// The free way straight ahead; [`WINDOW_M`] if nothing is there.
    pub fn ahead_m(&self) -> f64 {
        self.free_m[0]
    }

    /// The smallest turn to a side (1 left, -1 right), up to `largest_rad`, after which the whole
    /// window is free.
    pub fn free_turn_rad(&self, side: f64, largest_rad: f64) -> Option<f64> {
        let steps = (largest_rad.to_degrees() / DIRECTION_DEG) as usize;
        (0..=steps.min(DIRECTIONS - 1))
            .find(|step| {
                let index = if side > 0.0 {
                    *step
                } else {
                    (DIRECTIONS - step) % DIRECTIONS
                };
                self.free_m[index] >= WINDOW_M
            })
            .map(|step| (step as f64 * DIRECTION_DEG).to_radians())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram(echoes: &[(f64, f64)]) -> PolarHistogram {
        PolarHistogram::new(echoes.iter().map(|(distance_m, bearing_deg)| Sighting {
            distance_m: *distance_m,
            bearing_rad: bearing_deg.to_radians(),
        }))
    }

    #[test]
    fn without_echoes_all_is_free() {
        let free = histogram(&[(WINDOW_M, 0.0)]);
        assert!((free.ahead_m() - WINDOW_M).abs() < 1e-12);
        assert_eq!(free.free_turn_rad(1.0, 3.0), Some(0.0));
    }

    #[test]
    fn an_echo_covers_what_the_robot_needs_beside_it() {
        // asin(0.16 / 0.32) is 30 degrees.
        let ahead = histogram(&[(0.32, 0.0)]);
        assert!((ahead.ahead_m() - 0.32).abs() < 1e-12);
        for side in [1.0, -1.0] {
            let turn_rad = ahead.free_turn_rad(side, 3.0).expect("a way");
            assert!((30.0..=35.1).contains(&turn_rad.to_degrees()), "{turn_rad}");
        }
    }

    #[test]
    fn an_echo_across_the_rear_is_behind_for_both_sides() {
        let behind = histogram(&[(0.3, 179.0), (0.3, -90.0)]);
        assert!((behind.ahead_m() - WINDOW_M).abs() < 1e-12);
        assert_eq!(behind.free_turn_rad(-1.0, 0.1), Some(0.0));
    }

    #[test]
    fn there_may_be_no_way() {
        let walls: Vec<_> = (0..36).map(|step| (0.4, f64::from(step) * 10.0)).collect();
        assert_eq!(histogram(&walls).free_turn_rad(1.0, 6.0), None);
        // Something at the very centre covers everything in front of it.
        assert_eq!(histogram(&[(0.01, 0.0)]).free_turn_rad(1.0, 1.0), None);
    }
}
