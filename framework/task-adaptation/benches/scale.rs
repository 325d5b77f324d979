//! How long the first decision takes: generate all candidates, judge them by what the task gives,
//! choose. Against brute force where that is still possible.

#[path = "../tests/support/brute_force.rs"]
mod brute_force;
#[path = "../tests/support/mod.rs"]
mod support;

use std::hint::black_box;
use std::time::{Duration, Instant};

use brute_force::brute_force;
use support::chain;
use system_model::task::TaskSpecification;
use task_adaptation::{Answer, Generation, Room, choose, generate, given, judge_all};

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

/// The first decision of a task that nothing is done about yet.
fn decide(task: &TaskSpecification) -> Generation {
    let generation = generate(task, None).expect("few links");
    let answers = generation.candidates.iter();
    let answers = answers.map(|candidate| Answer::Performances(given(task, &candidate.placements)));
    let answers: Vec<Answer> = answers.collect();
    let mut judged = judge_all(task, &generation.candidates, &answers);
    black_box(choose(task, &mut judged, None));
    generation
}

fn row(name: &str, task: &TaskSpecification) {
    let found = decide(task);
    let decision = median(|| {
        black_box(decide(black_box(task)));
    });
    let brute = match found.combinations {
        0..=MOST_COMBINATIONS => {
            let start = Instant::now();
            let all = brute_force(task);
            assert_eq!(all.combinations as u128, found.combinations);
            assert_eq!(all.representatives.len() as u128, found.groups);
            format!("{:.1}", start.elapsed().as_secs_f64() * 1e3)
        }
        _ => "-".to_owned(),
    };
    let count = |is_so: fn(&Room) -> bool| {
        let candidates = found.candidates.iter();
        candidates.filter(|it| is_so(&it.room)).count()
    };
    let not_first = count(|room| matches!(room, Room::EnoughHere));
    let unknown = count(|room| matches!(room, Room::Unknown(_)));
    println!(
        "| {name} | {:.3e} | {} | {} | {not_first}, {unknown} | {:.2} | {brute} |",
        found.combinations as f64,
        found.groups,
        found.candidates.len(),
        decision.as_secs_f64() * 1e3,
    );
}

fn main() {
    println!(
        "| robots x components + optional, room on a robot | combinations | groups | candidates | perhaps not the fewest hops, no room found | decision, ms | brute force, ms |"
    );
    println!("|---|---|---|---|---|---|---|");
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
