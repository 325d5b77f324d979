//! How the robot moves: directions, inertia, time-out, contact, a side without power.

use std::time::Duration;

use crate::driver::{Driver, empty_world, pose, wheels};
use robot_interface::serial_line::MotionCommand;
use robot_simulation::{Fault, Side};
use system_model::world::{Colour, ObstacleShape, ObstacleSpecification, Position};

const SECOND: Duration = Duration::from_secs(1);

#[test]
fn commands_move_the_robot_with_the_right_sign() {
    // Wheel speeds; signs of the way along x and of the turn.
    let cases = [
        (60.0, 60.0, 1.0, 0.0),
        (-60.0, -60.0, -1.0, 0.0),
        (-30.0, 30.0, 0.0, 1.0),
        (30.0, -30.0, 0.0, -1.0),
        (40.0, 60.0, 1.0, 1.0),
        (60.0, 40.0, 1.0, -1.0),
        (-40.0, -60.0, -1.0, -1.0),
        (0.0, 0.0, 0.0, 0.0),
    ];
    for (left, right, way, turn) in cases {
        let mut driver = Driver::new(&empty_world(), 1);
        driver.drive(wheels(left, right), SECOND);
        let moved = driver.simulation.pose();
        let case = format!("{left} {right}: {moved:?}");
        let sign = |value: f64| {
            if value.abs() < 0.01 {
                0.0
            } else {
                value.signum()
            }
        };
        assert_eq!(sign(moved.position.x_m - 3.0), way, "{case}");
        assert_eq!(sign(moved.heading_rad), turn, "{case}");
        let report = driver.last_report;
        assert_eq!(
            sign(f64::from(report.left_encoder_ticks)),
            sign(left),
            "{case}"
        );
        assert_eq!(
            sign(f64::from(report.right_encoder_ticks)),
            sign(right),
            "{case}"
        );
    }
}

#[test]
fn wheels_take_their_time_and_settle_at_the_commanded_speed() {
    for (left, right) in [(60.0, 60.0), (-40.0, 40.0), (30.0, 60.0)] {
        let mut driver = Driver::new(&empty_world(), 1);
        driver.drive(wheels(left, right), Duration::from_millis(100));
        let early = driver.simulation.wheel_rpm(Side::Right);
        assert!(
            early > 0.2 * right && early < 0.8 * right,
            "{early} of {right}"
        );
        let mut fastest = early;
        for _ in 0..40 {
            driver.drive(wheels(left, right), Duration::from_millis(50));
            fastest = fastest.max(driver.simulation.wheel_rpm(Side::Right));
        }
        for (side, wanted) in [(Side::Left, left), (Side::Right, right)] {
            let rpm = driver.simulation.wheel_rpm(side);
            assert!(
                (rpm - wanted).abs() < 2.0,
                "{side:?}: {rpm} instead of {wanted}"
            );
        }
        assert!(fastest < 1.1 * right, "overshoot to {fastest} of {right}");
    }
}

#[test]
fn encoders_measure_the_way() {
    let world = empty_world();
    let mut driver = Driver::new(&world, 1);
    driver.drive(wheels(60.0, 60.0), 2 * SECOND);
    let turns = f64::from(driver.last_report.left_encoder_ticks)
        / f64::from(world.robot.encoder_ticks_per_revolution);
    let counted_m = turns * std::f64::consts::TAU * world.robot.wheel_radius_m;
    let driven_m = driver.simulation.pose().position.x_m - 3.0;
    assert!(
        (counted_m - driven_m).abs() < 0.002,
        "{counted_m} counted, {driven_m} driven"
    );
}

#[test]
fn the_board_stops_by_itself_200_ms_after_the_last_command() {
    let mut driver = Driver::new(&empty_world(), 1);
    driver.drive(wheels(60.0, 60.0), SECOND);
    driver.command(wheels(60.0, 60.0));
    driver.wait(Duration::from_millis(200));
    assert!(!driver.last_report.stopped_by_time_out);
    assert!(driver.simulation.wheel_rpm(Side::Left) > 55.0);
    driver.wait(Duration::from_millis(20));
    assert!(driver.last_report.stopped_by_time_out);
    driver.wait(SECOND);
    assert!(driver.simulation.wheel_rpm(Side::Left).abs() < 1.0);
    driver.drive(wheels(60.0, 60.0), SECOND);
    assert!(!driver.last_report.stopped_by_time_out);
    assert!(driver.simulation.wheel_rpm(Side::Left) > 55.0);
}

#[test]
fn damaged_commands_do_not_keep_the_motors_running() {
    let mut driver = Driver::new(&empty_world(), 1);
    driver.drive(wheels(60.0, 60.0), SECOND);
    for _ in 0..10 {
        driver.send_damaged(wheels(60.0, 60.0));
        driver.wait(Duration::from_millis(50));
    }
    assert!(driver.last_report.stopped_by_time_out);
}

#[test]
fn an_obstacle_stops_the_robot_and_counts_once() {
    let mut world = empty_world();
    world.obstacles.push(ObstacleSpecification {
        centre: Position { x_m: 3.8, y_m: 2.0 },
        shape: ObstacleShape::Circle { radius_m: 0.2 },
        height_m: 0.5,
        colour: Colour {
            red: 100,
            green: 100,
            blue: 100,
        },
    });
    let mut driver = Driver::new(&world, 1);
    driver.drive(wheels(60.0, 60.0), 5 * SECOND);
    let summary = driver.simulation.summary();
    assert_eq!(summary.collisions, 1, "{summary:?}");
    assert!(summary.least_clearance_m < 0.002, "{summary:?}");
    // The front of the robot at the face of the obstacle.
    assert!((driver.simulation.pose().position.x_m - (3.6 - 0.105)).abs() < 0.01);
    driver.drive(wheels(-60.0, -60.0), 2 * SECOND);
    driver.drive(wheels(60.0, 60.0), 5 * SECOND);
    assert_eq!(driver.simulation.summary().collisions, 2);
}

#[test]
fn a_wall_holds_the_robot_whatever_it_does() {
    let mut driver = Driver::new(&empty_world(), 1);
    driver.drive(wheels(100.0, 100.0), 20 * SECOND);
    driver.drive(wheels(100.0, 60.0), 10 * SECOND);
    let Position { x_m, y_m } = driver.simulation.pose().position;
    assert!(
        (0.0..6.0).contains(&x_m) && (0.0..4.0).contains(&y_m),
        "{x_m} {y_m}"
    );
    assert!(driver.simulation.summary().collisions >= 1);
}

#[test]
fn wheels_without_power_are_dragged_along() {
    let mut world = empty_world();
    world.robot.start = pose(1.0, 1.0, 0.0);
    let mut driver = Driver::new(&world, 1);
    driver.drive(wheels(60.0, 60.0), 2 * SECOND);
    driver
        .simulation
        .set_fault(Fault::MotorDriverOff(Side::Left));
    let mut below_half_after = None;
    for tenth in 1..=30_u32 {
        driver.drive(wheels(60.0, 60.0), Duration::from_millis(100));
        let rpm = driver.simulation.wheel_rpm(Side::Left);
        assert!(rpm > 10.0, "{rpm} rpm after {tenth} tenths of a second");
        if rpm < 30.0 {
            below_half_after.get_or_insert(tenth);
        }
    }
    // Figure 10: not at once, and well before two seconds.
    assert!(
        matches!(below_half_after, Some(4..=18)),
        "{below_half_after:?}"
    );
    assert!((driver.simulation.wheel_rpm(Side::Right) - 60.0).abs() < 3.0);
    driver
        .simulation
        .clear_fault(Fault::MotorDriverOff(Side::Left));
    driver.drive(wheels(60.0, 60.0), 2 * SECOND);
    assert!((driver.simulation.wheel_rpm(Side::Left) - 60.0).abs() < 2.0);
}

#[test]
fn a_dead_encoder_stands_still_while_the_wheel_turns() {
    let mut driver = Driver::new(&empty_world(), 1);
    driver.simulation.set_fault(Fault::EncoderDead(Side::Right));
    driver.drive(wheels(60.0, 60.0), SECOND);
    assert_eq!(driver.last_report.right_encoder_ticks, 0);
    assert!(driver.last_report.left_encoder_ticks > 200);
    driver
        .simulation
        .clear_fault(Fault::EncoderDead(Side::Right));
    driver.drive(wheels(60.0, 60.0), SECOND);
    let report = driver.last_report;
    assert!(
        (200..report.left_encoder_ticks).contains(&report.right_encoder_ticks),
        "{report:?}"
    );
}

#[test]
fn the_target_is_reached_within_its_distance() {
    let mut world = empty_world();
    world.robot.start = pose(3.0, 3.2, 0.0);
    let mut driver = Driver::new(&world, 1);
    let before = driver.simulation.summary();
    assert!(!before.reached && before.time_s.is_none());
    driver.drive(wheels(90.0, 90.0), 10 * SECOND);
    driver.drive(MotionCommand::stop(), SECOND);
    let summary = driver.simulation.summary();
    assert!(summary.reached, "{summary:?}");
    assert!(
        summary
            .time_s
            .is_some_and(|time_s| (5.0..8.0).contains(&time_s)),
        "{summary:?}"
    );
    // It drove on and pushes against the target, which is no collision.
    assert_eq!(summary.collisions, 0);
    assert!(summary.distance_to_target_m < 0.01);
    assert!(
        (summary.path_length_m - (5.2 - 0.12 - 0.105 - 3.0)).abs() < 0.05,
        "{summary:?}"
    );
}
