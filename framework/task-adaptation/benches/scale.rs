//! How long the first decision takes: generate all candidates, judge them by what the task gives,
//! choose. Against brute force where that is still possible.

#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;
use std::time::{Duration, Instant};

use support::brute_force::brute_force;
use support::chain;
use system_model::task::TaskSpecification;
use task_adaptation::plan;

/// Brute force holds all combinations in memory.
const MOST_COMBINATIONS: u128 = 2_000_000;
/// The median of so many is told.
const REPETITIONS: usize = 11;

fn median(mut repeat: impl FnMut()) -> Duration {
    let mut times: Vec<Duration> = (0..REPETITIONS)
        .map(|_| {
            let start = Instant::now();
            repeat();
            start.elapsed()
        })
        .collect();
    times.sort_unstable();
    times[REPETITIONS / 2]
}

fn row(name: &str, task: &TaskSpecification) {
    let found = plan(task).expect("few links").generation;
    let decision = median(|| {
        black_box(plan(black_box(task))).expect("few links");
    });
    let brute = match found.combinations {
        0..=MOST_COMBINATIONS => {
            let start = Instant::now();
            let count = brute_force(task).representatives.len();
            assert_eq!(count as u128, found.groups);
            format!("{:.1}", start.elapsed().as_secs_f64() * 1e3)
        }
        _ => "-".to_owned(),
    };
    println!(
        "| {name} | {:.3e} | {} | {} | {:.2} | {brute} |",
        found.combinations as f64,
        found.groups,
        found.candidates.len(),
        decision.as_secs_f64() * 1e3,
    );
}

fn main() {
    println!(
        "| robots x components + optional, room on a robot | combinations | groups | candidates | decision, ms | brute force, ms |"
    );
    println!("|---|---|---|---|---|---|");
    for (robots, components, optional) in [
        (2, 5, 2),
        (3, 6, 2),
        (4, 7, 3),
        (5, 7, 3),
        (2, 20, 3),
        (5, 20, 3),
        (10, 5, 3),
        (10, 10, 3),
        (10, 20, 0),
        (10, 20, 1),
        (10, 20, 2),
        (10, 20, 3),
        (10, 40, 3),
    ] {
        let name = format!("{robots} x {components} + {optional}");
        row(
            &format!("{name}, all"),
            &chain(robots, components, optional, 1e3),
        );
        // Every candidate needs several robots then, so the first placement never has room.
        let tight = (components / 3).max(2) as f64;
        row(
            &format!("{name}, {tight}"),
            &chain(robots, components, optional, tight),
        );
    }
}
