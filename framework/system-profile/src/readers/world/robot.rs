//! What drives in the world: the robot, its ultrasonic sensors and its camera.

use std::ops::RangeInclusive;

use system_model::world::{
    ArenaSpecification, CameraSpecification, Pose, RobotSpecification, SONAR_COUNT,
    SonarSpecification,
};

use super::quantity::{
    DISTANCE_M, SIZE_M, attribute, heading_rad, interval, measure, mount, place,
};
use crate::node::Node;

const MASS_KG: RangeInclusive<f64> = 0.01..=1000.0;
/// Commands carry wheel speeds as 16-bit numbers.
const WHEEL_RPM: RangeInclusive<f64> = 1.0..=10_000.0;
/// From a step of the physics to a robot that nobody would wait for.
const TIME_CONSTANT_S: RangeInclusive<f64> = 0.005..=10.0;
const TICKS: RangeInclusive<u32> = 1..=100_000;
/// Reports carry ranges in mm as 16-bit numbers.
const SONAR_RANGE_M: RangeInclusive<f64> = 0.0..=65.0;
const CONE_DEG: RangeInclusive<f64> = 0.0..=180.0;
const NOISE_M: RangeInclusive<f64> = 0.0..=1.0;
/// A pinhole sees less than half of everything; near that, pictures are all edge.
const FIELD_OF_VIEW_DEG: RangeInclusive<f64> = 1.0..=170.0;
/// The camera stream carries at most 640 x 480 pixels.
const PICTURE_WIDTH: RangeInclusive<u16> = 1..=640;
const PICTURE_HEIGHT: RangeInclusive<u16> = 1..=480;
/// The world moves in steps of 5 ms.
const PICTURE_RATE_HZ: RangeInclusive<f64> = 0.01..=200.0;

/// The robot.
pub(super) fn read(
    node: &Node<'_>,
    arena: Option<&ArenaSpecification>,
) -> Option<RobotSpecification> {
    let start = node.required_child("start").and_then(|node| {
        let (position, heading_rad) = (place(&node, arena), heading_rad(&node));
        node.finish();
        Some(Pose {
            position: position?,
            heading_rad: heading_rad?,
        })
    });
    let [length_m, width_m, wheel_radius_m, track_m] =
        ["length_m", "width_m", "wheel_radius_m", "track_m"]
            .map(|name| measure(node, name, SIZE_M));
    let mass_kg = measure(node, "mass_kg", MASS_KG);
    let wheel_maximum_rpm = measure(node, "wheel_maximum_rpm", WHEEL_RPM);
    let motor_time_constant_s = measure(node, "motor_time_constant_s", TIME_CONSTANT_S);
    let encoder_ticks_per_revolution = measure(node, "encoder_ticks_per_revolution", TICKS);
    node.finish();
    Some(RobotSpecification {
        start: start?,
        length_m: length_m?,
        width_m: width_m?,
        mass_kg: mass_kg?,
        wheel_radius_m: wheel_radius_m?,
        track_m: track_m?,
        wheel_maximum_rpm: wheel_maximum_rpm?,
        motor_time_constant_s: motor_time_constant_s?,
        encoder_ticks_per_revolution: encoder_ticks_per_revolution?,
    })
}

/// One sensor for each socket of the motion board.
pub(super) fn sonars(node: &Node<'_>) -> Option<[SonarSpecification; SONAR_COUNT]> {
    let sonars = node.children("sonar");
    let count = sonars.len();
    let sonars: Vec<SonarSpecification> = sonars.iter().filter_map(sonar).collect();
    if count != SONAR_COUNT {
        node.error(
            format!("<sonars> holds {count} sonars, not {SONAR_COUNT}"),
            Some("the motion board has a socket for each: front, left, right, rear".into()),
        );
    }
    node.finish();
    sonars.try_into().ok()
}

fn sonar(node: &Node<'_>) -> Option<SonarSpecification> {
    let mount = mount(node);
    let cone_angle_deg = measure(node, "cone_angle_deg", CONE_DEG);
    let range_m = interval(node, "range", ["minimum_m", "maximum_m"], &SONAR_RANGE_M);
    let noise_sigma_m = measure(node, "noise_sigma_m", NOISE_M);
    node.finish();
    let (range_minimum_m, range_maximum_m) = range_m?;
    Some(SonarSpecification {
        mount: mount?,
        cone_angle_rad: cone_angle_deg?.to_radians(),
        range_minimum_m,
        range_maximum_m,
        noise_sigma_m: noise_sigma_m?,
    })
}

/// The camera.
pub(super) fn camera(node: &Node<'_>) -> Option<CameraSpecification> {
    let mount = mount(node);
    let height_m = measure(node, "height_m", DISTANCE_M);
    let field_of_view_deg = measure(node, "field_of_view_deg", FIELD_OF_VIEW_DEG);
    let picture = node.required_child("picture").and_then(|node| {
        let width = attribute(&node, "width", PICTURE_WIDTH);
        let height = attribute(&node, "height", PICTURE_HEIGHT);
        node.finish();
        Some((width?, height?))
    });
    let rate_hz = measure(node, "rate_hz", PICTURE_RATE_HZ);
    node.finish();
    let (picture_width, picture_height) = picture?;
    Some(CameraSpecification {
        mount: mount?,
        height_m: height_m?,
        field_of_view_rad: field_of_view_deg?.to_radians(),
        picture_width,
        picture_height,
        rate_hz: rate_hz?,
    })
}
