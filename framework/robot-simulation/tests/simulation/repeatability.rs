//! The same world, seed and bytes at the same times give the same drive, bit for bit.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::Duration;

use system_model::world::WorldSpecification;

use crate::driver::{Driver, wheels};

/// A hash of poses, reports and pictures along a drive that also bumps into things.
fn drive_hash(seed: u64, steps_of_ms: u64) -> u64 {
    let mut driver = Driver::new(&WorldSpecification::default(), seed);
    let mut hasher = DefaultHasher::new();
    for turn in 0..60_u64 {
        driver.command(wheels(70.0, 70.0 - 2.0 * (turn % 20) as f64));
        let mut picture = None;
        for _ in 0..100 / steps_of_ms {
            picture = driver.wait(Duration::from_millis(steps_of_ms)).or(picture);
        }
        let pose = driver.simulation.pose();
        pose.position.x_m.to_bits().hash(&mut hasher);
        pose.position.y_m.to_bits().hash(&mut hasher);
        pose.heading_rad.to_bits().hash(&mut hasher);
        let report = driver.last_report;
        (
            report.left_encoder_ticks,
            report.right_encoder_ticks,
            report.ranges_mm,
        )
            .hash(&mut hasher);
        picture
            .expect("a picture each 100 ms")
            .pixels
            .hash(&mut hasher);
    }
    hasher.finish()
}

#[test]
fn the_same_seed_gives_the_same_drive() {
    assert_eq!(drive_hash(7, 100), drive_hash(7, 100));
}

#[test]
fn the_size_of_the_strides_through_time_does_not_matter() {
    assert_eq!(drive_hash(7, 100), drive_hash(7, 5));
    assert_eq!(drive_hash(7, 100), drive_hash(7, 20));
}

#[test]
fn different_seeds_give_different_drives() {
    assert_ne!(drive_hash(7, 100), drive_hash(8, 100));
}
