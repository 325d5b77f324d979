//! A planner that sees only what a real one sees reaches the target of the reference world.

use std::path::PathBuf;
use std::time::Duration;

use crate::driver::Driver;
use crate::planner::Planner;
use robot_interface::serial_line::MotionCommand;
use robot_simulation::{RobotSummary, draw_drive};
use system_model::world::WorldSpecification;

const SEEDS: u64 = 20;

fn drive_to_target(seed: u64) -> (RobotSummary, Driver) {
    let mut driver = Driver::new(&WorldSpecification::default(), seed);
    let mut planner = Planner::new();
    for _ in 0..2_000 {
        let picture = driver.wait(Duration::from_millis(50));
        let command = planner.plan(picture.as_ref(), driver.last_report.ranges_mm);
        driver.command(command);
        if driver.simulation.summary().reached {
            driver.drive(MotionCommand::stop(), Duration::from_secs(1));
            break;
        }
    }
    (driver.simulation.summary(), driver)
}

/// `DRIVE_PICTURES=folder` leaves a picture of each drive there.
#[test]
fn a_reactive_planner_reaches_the_target_without_touching_anything() {
    let pictures = std::env::var_os("DRIVE_PICTURES").map(PathBuf::from);
    let mut failures = Vec::new();
    for seed in 0..SEEDS {
        let (summary, driver) = drive_to_target(seed);
        if let Some(folder) = &pictures {
            let file = folder.join(format!("{seed}.svg"));
            std::fs::write(file, draw_drive(&driver.simulation)).expect("a folder");
        }
        println!("{seed}: {summary:?}");
        if !summary.reached || summary.collisions > 0 {
            failures.push((seed, summary));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn a_summary_has_the_keys_of_the_summary_file() {
    let (summary, _) = drive_to_target(0);
    let json = serde_json::to_value(summary).expect("JSON");
    let keys: Vec<&String> = json.as_object().expect("an object").keys().collect();
    let expected = [
        "collisions",
        "distance_to_target_m",
        "least_clearance_m",
        "path_length_m",
        "reached",
        "time_s",
    ];
    assert_eq!(keys, expected);
}

#[test]
fn the_picture_of_a_drive_is_the_same_for_the_same_drive_and_is_well_formed() {
    let picture = draw_drive(&drive_to_target(0).1.simulation);
    assert_eq!(picture, draw_drive(&drive_to_target(0).1.simulation));
    let depth = svg::read(&picture)
        .expect("SVG")
        .try_fold(0, |depth, event| match event {
            svg::parser::Event::Tag(_, svg::node::element::tag::Type::Start, _) => Some(depth + 1),
            svg::parser::Event::Tag(_, svg::node::element::tag::Type::End, _) => Some(depth - 1),
            svg::parser::Event::Error(_) => None,
            _ => Some(depth),
        });
    assert_eq!(depth, Some(0));
    assert!(picture.contains("seed 0: target reached after"));
}
