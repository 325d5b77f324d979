//! Ultrasonic sensors: the nearest thing in a cone.

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use system_model::world::{Pose, SonarSpecification};

use crate::geometry::compose;
use crate::physics::Physics;

/// Rays across the cone, odd so that one runs along its axis. 2.5 degrees apart in a cone of 30:
/// at the full range of 3 m the smallest obstacle of the reference arena still meets one.
const RAYS: u32 = 13;

/// One range in m, within what the sensor can report.
pub(crate) fn measure_m(
    physics: &Physics,
    robot: Pose,
    sonar: &SonarSpecification,
    random: &mut Pcg64,
) -> f64 {
    let sensor = compose(robot, sonar.mount);
    let nearest_m = (0..RAYS)
        .filter_map(|ray| {
            let share = f64::from(ray) / f64::from(RAYS - 1) - 0.5;
            let heading_rad = sensor.heading_rad + share * sonar.cone_angle_rad;
            physics.nearest_on_ray(sensor.position, heading_rad, sonar.range_maximum_m)
        })
        .fold(sonar.range_maximum_m, f64::min);
    // Drawn also when nothing is in range, so that the noise does not depend on the world.
    let noise: f64 = StandardNormal.sample(random);
    if nearest_m >= sonar.range_maximum_m {
        return sonar.range_maximum_m;
    }
    (nearest_m + noise * sonar.noise_sigma_m).clamp(sonar.range_minimum_m, sonar.range_maximum_m)
}
