//! Where the sonars have met something lately, in the coordinates of the odometry.

use component_sdk::PortData;
use robot_interface::port_data::WheelOdometry;

/// Echoes of some seconds around a robot of this size; the oldest gives way.
const ECHO_COUNT: usize = 64;
/// Farther echoes do not matter yet, and are too vague: a cone of 30 degrees is half a metre wide
/// there.
const FARTHEST_KEPT_M: f64 = 1.0;
/// The odometry drifts, and things may move: what was not seen for so long is forgotten.
const MEMORY_NS: u64 = 6_000_000_000;
/// Echoes this near to each other are one.
const SAME_PLACE_M: f64 = 0.05;
/// A range this much longer than the way to an echo says that the thing is gone.
const GONE_M: f64 = 0.10;
/// Half of the part of a sensor's cone in which it is trusted to see everything.
const SURE_HALF_CONE_RAD: f64 = 0.2;

/// Where a sensor sits on the robot, and which of them it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Position in the order of the motion board's sockets.
    pub index: usize,
    x_m: f64,
    y_m: f64,
    heading_deg: f64,
}

/// The sensor in front.
pub const FRONT: Sensor = sensor(0, 0.105, 0.0, 0.0);
/// The sensor at the left front corner.
pub const LEFT: Sensor = sensor(1, 0.095, 0.060, 40.0);
/// The sensor at the right front corner.
pub const RIGHT: Sensor = sensor(2, 0.095, -0.060, -40.0);
/// The sensor behind.
pub const REAR: Sensor = sensor(3, -0.105, 0.0, 180.0);

const fn sensor(index: usize, x_m: f64, y_m: f64, heading_deg: f64) -> Sensor {
    Sensor {
        index,
        x_m,
        y_m,
        heading_deg,
    }
}

/// Something met at a place; time 0 marks a free entry.
#[derive(PortData, Debug, Clone, Copy)]
#[repr(C)]
struct Echo {
    x: f64,
    y: f64,
    time: u64,
}

const NO_ECHO: Echo = Echo {
    x: 0.0,
    y: 0.0,
    time: 0,
};

/// The echoes.
#[derive(PortData, Debug, Clone, Copy)]
#[repr(C)]
pub struct EchoMap {
    echoes: [Echo; ECHO_COUNT],
}

/// An echo as seen from the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// From the robot's centre.
    pub distance_m: f64,
    /// From straight ahead, counterclockwise.
    pub bearing_rad: f64,
}

impl EchoMap {
    /// A map without echoes.
    pub fn new() -> Self {
        Self {
            echoes: [NO_ECHO; ECHO_COUNT],
        }
    }

    /// Takes a range that a sensor has measured from this pose: what it looks through is gone, and
    /// where it ends there is something.
    pub fn take_range(&mut self, sensor: &Sensor, range_m: f64, pose: &WheelOdometry) {
        let (sine, cosine) = pose.heading.sin_cos();
        let x = pose.x + cosine * sensor.x_m - sine * sensor.y_m;
        let y = pose.y + sine * sensor.x_m + cosine * sensor.y_m;
        let direction_rad = pose.heading + sensor.heading_deg.to_radians();
        for echo in &mut self.echoes {
            let (along, aside) = (echo.x - x, echo.y - y);
            let angle_rad = wrapped_rad(aside.atan2(along) - direction_rad);
            if angle_rad.abs() < SURE_HALF_CONE_RAD && along.hypot(aside) < range_m - GONE_M {
                *echo = NO_ECHO;
            }
        }
        if range_m < FARTHEST_KEPT_M {
            self.remember(Echo {
                x: x + range_m * direction_rad.cos(),
                y: y + range_m * direction_rad.sin(),
                // Never 0, which marks a free entry.
                time: pose.time.max(1),
            });
        }
    }

    /// The echoes that still count, as seen from this pose.
    pub fn sightings(&self, pose: &WheelOdometry) -> impl Iterator<Item = Sighting> {
        let pose = *pose;
        let is_kept =
            move |echo: &&Echo| echo.time > 0 && pose.time.saturating_sub(echo.time) < MEMORY_NS;
        self.echoes.iter().filter(is_kept).map(move |echo| {
            let (along, aside) = (echo.x - pose.x, echo.y - pose.y);
            Sighting {
                distance_m: along.hypot(aside),
                bearing_rad: wrapped_rad(aside.atan2(along) - pose.heading),
            }
        })
    }

    fn remember(&mut self, new: Echo) {
        let is_same =
            |old: &&mut Echo| old.time > 0 && (old.x - new.x).hypot(old.y - new.y) < SAME_PLACE_M;
        if let Some(same) = self.echoes.iter_mut().find(is_same) {
            *same = new;
        } else if let Some(oldest) = self.echoes.iter_mut().min_by_key(|echo| echo.time) {
            *oldest = new;
        }
    }
}

/// The same angle from -pi to pi.
fn wrapped_rad(angle_rad: f64) -> f64 {
    angle_rad.sin().atan2(angle_rad.cos())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn pose(x: f64, y: f64, heading: f64, time: u64) -> WheelOdometry {
        WheelOdometry {
            time,
            x,
            y,
            heading,
            ..WheelOdometry::default()
        }
    }

    #[test]
    fn an_echo_stays_where_it_is_while_the_robot_moves() {
        let mut map = EchoMap::new();
        map.take_range(&FRONT, 0.5, &pose(1.0, 2.0, 0.0, 1));
        // The echo is at (1.605, 2); half a metre to its side, it is to the right behind nothing.
        let seen: Vec<_> = map.sightings(&pose(1.605, 2.5, 0.0, 2)).collect();
        assert_eq!(seen.len(), 1);
        assert!((seen[0].distance_m - 0.5).abs() < 1e-9);
        assert!((seen[0].bearing_rad + PI / 2.0).abs() < 1e-9);
    }

    #[test]
    fn each_sensor_looks_its_own_way() {
        for (sensor, bearing_deg) in [
            (FRONT, 0.0_f64),
            (LEFT, 40.0),
            (RIGHT, -40.0),
            (REAR, 180.0),
        ] {
            let mut map = EchoMap::new();
            map.take_range(&sensor, 0.8, &pose(0.0, 0.0, 0.0, 1));
            let seen = map
                .sightings(&pose(0.0, 0.0, 0.0, 1))
                .next()
                .expect("an echo");
            let error_rad = wrapped_rad(seen.bearing_rad - bearing_deg.to_radians());
            assert!(error_rad.abs() < 0.05, "{sensor:?}: {seen:?}");
        }
    }

    #[test]
    fn what_a_sensor_looks_through_is_gone() {
        let mut map = EchoMap::new();
        let here = pose(0.0, 0.0, 0.0, 1);
        map.take_range(&FRONT, 0.4, &here);
        map.take_range(&LEFT, 0.4, &here);
        map.take_range(&FRONT, 3.0, &here);
        assert_eq!(map.sightings(&here).count(), 1);
    }

    #[test]
    fn echoes_are_forgotten_merged_and_bounded() {
        let mut map = EchoMap::new();
        map.take_range(&FRONT, 0.40, &pose(0.0, 0.0, 0.0, 1));
        map.take_range(&FRONT, 0.42, &pose(0.0, 0.0, 0.0, 2));
        assert_eq!(map.sightings(&pose(0.0, 0.0, 0.0, 2)).count(), 1);
        assert_eq!(
            map.sightings(&pose(0.0, 0.0, 0.0, MEMORY_NS + 2)).count(),
            0
        );
        for step in 0..1000 {
            map.take_range(&LEFT, 0.3, &pose(f64::from(step) * 0.1, 0.0, 0.0, 3));
        }
        assert_eq!(map.sightings(&pose(0.0, 0.0, 0.0, 3)).count(), ECHO_COUNT);
    }
}
