//! What sonars and camera see.

use std::time::Duration;

use robot_interface::camera_stream::Picture;
use robot_interface::serial_line::MotionCommand;
use robot_simulation::Fault;
use system_model::world::{
    BandSpecification, Colour, ObstacleShape, ObstacleSpecification, Position, SmokeSpecification,
    SwaySpecification, TargetPlace, WorldSpecification,
};

use crate::driver::{Driver, empty_world, pose};

const ALL_SONARS: Duration = Duration::from_millis(200);

fn ranges_mm(world: &WorldSpecification) -> [u16; 4] {
    let mut driver = Driver::new(world, 1);
    driver.wait(ALL_SONARS);
    driver.last_report.ranges_mm
}

#[test]
fn ranges_are_exact_without_noise() {
    let mut world = empty_world();
    for sonar in &mut world.sonars {
        // A needle instead of a cone, so that the expected ranges are those of the axes.
        sonar.cone_angle_rad = 1e-9;
    }
    let slant = |gap_m: f64| (1000.0 * gap_m / 40.0_f64.to_radians().sin()).round() as u16;
    // Start pose; front, left front, right front, rear.
    let cases = [
        (pose(3.0, 2.0, 0.0), [2895, 3000, 3000, 2895]),
        (pose(5.0, 1.0, 0.0), [895, 1181, 1181, 3000]),
        (pose(5.0, 0.5, 0.0), [895, 1181, slant(0.44), 3000]),
        (
            pose(1.0, 2.0, 180.0_f64.to_radians()),
            [895, 1181, 1181, 3000],
        ),
        (
            pose(3.0, 2.0, 90.0_f64.to_radians()),
            [1895, 2487, 2487, 1895],
        ),
    ];
    for (start, expected) in cases {
        world.robot.start = start;
        let measured = ranges_mm(&world);
        for (range_mm, expected_mm) in measured.into_iter().zip(expected) {
            assert!(
                range_mm.abs_diff(expected_mm) <= 1,
                "{start:?}: {measured:?}, {expected:?}"
            );
        }
    }
}

#[test]
fn a_cone_sees_what_its_axis_misses_and_a_near_thing_reads_the_least_range() {
    let mut world = empty_world();
    let obstacle = |x_m, y_m| ObstacleSpecification {
        centre: Position { x_m, y_m },
        shape: ObstacleShape::Circle { radius_m: 0.1 },
        height_m: 0.5,
        colour: Colour {
            red: 100,
            green: 100,
            blue: 100,
        },
    };
    world.obstacles = vec![obstacle(4.105, 2.2)];
    let front_mm = ranges_mm(&world)[0];
    assert!((900..1000).contains(&front_mm), "{front_mm}");
    // The target, 15 mm in front of the robot at (3, 2).
    world.target.place = TargetPlace::Fixed(Position {
        x_m: 3.24,
        y_m: 2.0,
    });
    assert_eq!(ranges_mm(&world)[0], 30);
}

#[test]
fn noise_has_the_width_that_the_world_says() {
    let mut world = empty_world();
    world.robot.start = pose(4.0, 2.0, 0.0);
    world.sonars[0].noise_sigma_m = 0.02;
    let mut driver = Driver::new(&world, 1);
    let errors: Vec<f64> = (0..400)
        .map(|_| {
            driver.wait(Duration::from_millis(80));
            f64::from(driver.last_report.ranges_mm[0]) / 1000.0 - 1.895
        })
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let sigma =
        (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    assert!(
        mean.abs() < 0.005 && (0.017..0.023).contains(&sigma),
        "{mean} {sigma}"
    );
}

#[test]
fn an_unplugged_sonar_reads_zero_until_it_is_plugged_in() {
    let mut driver = Driver::new(&empty_world(), 1);
    driver.simulation.set_fault(Fault::UnplugSonar(2));
    driver.wait(ALL_SONARS);
    assert_eq!(
        driver.last_report.ranges_mm.map(|range_mm| range_mm == 0),
        [false, false, true, false]
    );
    driver.simulation.clear_fault(Fault::UnplugSonar(2));
    driver.wait(ALL_SONARS);
    assert!(driver.last_report.ranges_mm[2] > 0);
}

/// First and last column in which the target is seen, and the number of its pixels.
fn target_columns(picture: &Picture) -> Option<(usize, usize, usize)> {
    let columns: Vec<usize> = picture
        .pixels
        .chunks_exact(3)
        .enumerate()
        .filter(|(_, pixel)| pixel[0] > 180 && pixel[1] < 80 && pixel[2] < 80)
        .map(|(index, _)| index % usize::from(picture.width))
        .collect();
    Some((
        *columns.iter().min()?,
        *columns.iter().max()?,
        columns.len(),
    ))
}

fn picture(world: &WorldSpecification, fault: Option<Fault>) -> Picture {
    let mut driver = Driver::new(world, 1);
    if let Some(fault) = fault {
        driver.simulation.set_fault(fault);
    }
    driver
        .drive(MotionCommand::stop(), Duration::from_millis(300))
        .expect("a picture")
}

#[test]
fn the_target_appears_at_its_bearing_with_its_size() {
    let mut world = empty_world();
    world.robot.start = pose(2.0, 2.0, 0.0);
    let focal_length = 80.0 / (world.camera.field_of_view_rad / 2.0).tan();
    // The lens is 0.09 m before the centre of the robot.
    for (x_m, y_m) in [
        (4.09, 2.0),
        (4.09, 2.6),
        (4.09, 1.2),
        (3.09, 2.0),
        (5.59, 2.5),
    ] {
        world.target.place = TargetPlace::Fixed(Position { x_m, y_m });
        let (first, last, _) = target_columns(&picture(&world, None)).expect("the target");
        let (depth_m, left_m) = (x_m - 2.09, y_m - 2.0);
        let seen = (first + last + 1) as f64 / 2.0;
        let expected = 80.0 - focal_length * left_m / depth_m;
        assert!(
            (seen - expected).abs() <= 1.5,
            "{x_m} {y_m}: column {seen}, not {expected}"
        );
        let width = (last + 1 - first) as f64;
        let expected = focal_length * 0.24 / depth_m;
        assert!(
            (width - expected).abs() <= 2.5,
            "{x_m} {y_m}: {width} wide, not {expected}"
        );
    }
}

#[test]
fn the_target_is_hidden_behind_an_obstacle_behind_the_robot_and_in_smoke() {
    let mut world = empty_world();
    world.robot.start = pose(2.0, 2.0, 0.0);
    world.target.place = TargetPlace::Fixed(Position { x_m: 5.0, y_m: 2.0 });
    assert!(target_columns(&picture(&world, None)).is_some());
    assert_eq!(
        target_columns(&picture(&world, Some(Fault::CameraSmoke(0.9)))),
        None
    );
    let mut behind = world.clone();
    behind.robot.start.heading_rad = std::f64::consts::PI;
    assert_eq!(target_columns(&picture(&behind, None)), None);
    world.obstacles.push(ObstacleSpecification {
        centre: Position { x_m: 4.0, y_m: 2.0 },
        shape: ObstacleShape::Box {
            length_m: 0.2,
            width_m: 0.6,
            heading_rad: 0.0,
        },
        height_m: 0.5,
        colour: Colour {
            red: 118,
            green: 104,
            blue: 84,
        },
    });
    assert_eq!(target_columns(&picture(&world, None)), None);
}

#[test]
fn the_target_sways_and_fades_when_smoke_begins() {
    let mut world = empty_world();
    world.robot.start = pose(2.0, 2.0, 0.0);
    world.target.place = TargetPlace::Fixed(Position { x_m: 4.0, y_m: 2.0 });
    world.target.sway = Some(SwaySpecification {
        amplitude_m: 0.5,
        period_s: 4.0,
    });
    world.smoke = Some(SmokeSpecification {
        begins_s: 2.0,
        scattering_per_m: 1.0,
        airlight: Colour {
            red: 200,
            green: 200,
            blue: 200,
        },
    });
    let mut driver = Driver::new(&world, 1);
    // The lens is at 2.09 m; 0.5 m to the left at a depth of 1.91 m are 33 columns.
    let mut column_after = |tenths: u64| {
        let picture = driver.drive(MotionCommand::stop(), Duration::from_millis(tenths * 100));
        let found = target_columns(&picture.expect("a picture"));
        found.map(|(first, last, _)| (first + last).div_ceil(2))
    };
    assert_eq!(column_after(10), Some(80 - 33));
    assert_eq!(column_after(9).map(|it| it.abs_diff(80) < 8), Some(true));
    assert_eq!(column_after(1), None, "smoke has come");
}

#[test]
fn the_target_has_bands() {
    let mut world = empty_world();
    world.robot.start = pose(2.0, 2.0, 0.0);
    world.target.place = TargetPlace::Fixed(Position { x_m: 3.0, y_m: 2.0 });
    let plain = target_columns(&picture(&world, None))
        .expect("the target")
        .2;
    world.target.bands = Some(BandSpecification {
        height_m: 0.05,
        colour: Colour {
            red: 20,
            green: 20,
            blue: 150,
        },
    });
    let banded = target_columns(&picture(&world, None))
        .expect("the target")
        .2;
    let share = banded as f64 / plain as f64;
    assert!((0.4..0.6).contains(&share), "{banded} of {plain} pixels");
}

#[test]
fn nothing_but_the_target_has_its_colour() {
    let mut world = WorldSpecification::default();
    world.target.place = TargetPlace::Fixed(Position { x_m: 0.3, y_m: 2.0 });
    world.robot.start = pose(1.5, 2.0, 0.0);
    for seed in 0..10 {
        let mut driver = Driver::new(&world, seed);
        let picture = driver.wait(Duration::from_millis(100)).expect("a picture");
        assert_eq!(target_columns(&picture), None, "seed {seed}");
    }
}

#[test]
fn pictures_come_ten_times_a_second_with_their_time() {
    let mut driver = Driver::new(&empty_world(), 1);
    for tenth in 1..=5 {
        let picture = driver.wait(Duration::from_millis(100)).expect("a picture");
        assert_eq!(picture.time_stamp_ns, tenth * 100_000_000);
        assert_eq!((picture.width, picture.height), (160, 120));
    }
    assert!(driver.wait(Duration::from_millis(95)).is_none());
}
