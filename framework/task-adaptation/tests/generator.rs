//! The generator equals brute force on all small cases.

#[path = "support/brute_force.rs"]
mod brute_force;
mod support;

use brute_force::brute_force;
use proptest::prelude::*;
use support::chain;
use system_model::task::{ComponentClass, HopCount, TaskLink, TaskSpecification};
use task_adaptation::{Candidate, Room, generate};

/// What makes a small task different from a chain on which everything is everywhere.
#[derive(Debug, Clone)]
struct Shape {
    robots: usize,
    components: usize,
    optional: usize,
    /// By component.
    classes: Vec<u8>,
    /// Whether a robot lacks a component, by both.
    lacks: Vec<bool>,
    /// What instances need, by robot and component.
    demands: Vec<u8>,
    rooms: Vec<u8>,
    /// Further links, by their ends.
    links: Vec<(usize, usize)>,
    excludes: bool,
    essential_hops: bool,
}

fn shapes() -> impl Strategy<Value = Shape> {
    (1..=3_usize, 2..=4_usize, 0..=2_usize).prop_flat_map(|(robots, components, optional)| {
        let all = components + optional;
        (
            prop::collection::vec(0..3_u8, all),
            prop::collection::vec(prop::bool::weighted(0.2), all * robots),
            prop::collection::vec(0..4_u8, all * robots),
            prop::collection::vec(0..12_u8, robots),
            prop::collection::vec((0..components, 0..components), 0..3),
            any::<(bool, bool)>(),
        )
            .prop_map(
                move |(classes, lacks, demands, rooms, links, (excludes, essential_hops))| Shape {
                    robots,
                    components,
                    optional,
                    classes,
                    lacks,
                    demands,
                    rooms,
                    links,
                    excludes,
                    essential_hops,
                },
            )
    })
}

fn task(shape: &Shape) -> TaskSpecification {
    let mut task = chain(shape.robots, shape.components, shape.optional, 0.0);
    let all = shape.components + shape.optional;
    for (component, class) in task.components.iter_mut().zip(&shape.classes) {
        component.class = match class {
            0 => ComponentClass::Sensor,
            1 => ComponentClass::Actuator,
            _ => ComponentClass::Computation,
        };
    }
    for (robot, specification) in task.robots.iter_mut().enumerate() {
        specification.available = vec![f64::from(shape.rooms[robot])];
        for instance in &mut specification.instances {
            let demand = shape.demands[robot * all + instance.component];
            instance.demand = vec![f64::from(demand)];
        }
        let lacks = |component: usize| shape.lacks[robot * all + component];
        specification.instances.retain(|it| !lacks(it.component));
    }
    let links = shape.links.iter().filter(|(from, to)| from != to);
    task.links.extend(links.map(|(from, to)| TaskLink {
        from: *from,
        to: *to,
        through: (shape.components..all).collect(),
        ports: system_model::task::LinkPorts::default(),
    }));
    if shape.excludes && shape.optional > 1 {
        task.exclusions = vec![(shape.components..all).collect()];
    }
    // More than the largest of these shapes has groups.
    task.generation.limit = 10_000;
    if shape.essential_hops {
        task.generation.hops = HopCount::Essential;
    }
    task
}

fn found(candidate: &Candidate) -> ((Vec<system_model::task::Placement>, u32), bool) {
    assert!(
        !matches!(candidate.room, Room::Unknown(_) | Room::EnoughHere),
        "a small case is searched to its end"
    );
    let fits = candidate.room == Room::Enough;
    ((candidate.placements.clone(), candidate.hops), fits)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn best_first_finds_what_brute_force_finds(shape in shapes()) {
        let task = task(&shape);
        let expected = brute_force(&task);
        let generation = generate(&task, None).expect("few links");
        prop_assert_eq!(generation.combinations, expected.combinations as u128);
        prop_assert_eq!(generation.groups, expected.representatives.len() as u128);
        let found: Vec<_> = generation.candidates.iter().map(found).collect();
        prop_assert_eq!(found, expected.representatives);
    }

    #[test]
    fn under_a_limit_those_with_the_fewest_hops_remain(shape in shapes(), limit in 1..6_usize) {
        let mut task = task(&shape);
        for robot in &mut task.robots {
            robot.available = vec![1e6];
        }
        let all = generate(&task, None).expect("few links").candidates;
        task.generation.limit = limit;
        let some = generate(&task, None).expect("few links");
        prop_assert_eq!(some.candidates.len(), limit.min(all.len()));
        prop_assert_eq!(some.left_out, (all.len() - some.candidates.len()) as u128);
        let mut hops: Vec<u32> = all.iter().map(|it| it.hops).collect();
        hops.sort_unstable();
        hops.truncate(limit);
        let mut left: Vec<u32> = some.candidates.iter().map(|it| it.hops).collect();
        left.sort_unstable();
        prop_assert_eq!(left, hops);
        prop_assert!(some.candidates.iter().all(|it| all.contains(it)));
    }
}

#[test]
fn what_nobody_has_is_named() {
    let mut task = chain(2, 3, 0, 10.0);
    for robot in &mut task.robots {
        robot.instances.retain(|it| it.component != 1);
    }
    let generation = generate(&task, None).expect("few links");
    assert_eq!(
        (generation.combinations, generation.candidates.len()),
        (0, 0)
    );
    assert_eq!(generation.lacking, [1]);
}

#[test]
fn where_a_robot_is_full_others_help() {
    // Six components of one unit on three robots that have room for two each: two in a row.
    let task = chain(3, 6, 0, 2.0);
    let generation = generate(&task, None).expect("few links");
    let here = |candidate: &&Candidate| candidate.placements[0].robot == 0;
    let elsewhere = generation
        .candidates
        .iter()
        .filter(here)
        .find(|it| it.placements[5].robot == 2);
    let candidate = elsewhere.expect("from the first robot to the third");
    let robots: Vec<usize> = candidate.placements.iter().map(|it| it.robot).collect();
    assert_eq!((robots, candidate.hops), (vec![0, 0, 1, 1, 2, 2], 2));
    assert_eq!(candidate.room, Room::Enough);
}

#[test]
fn where_all_are_nearly_full_a_placement_is_found_all_the_same() {
    let task = chain(10, 20, 1, 3.0);
    for candidate in generate(&task, None).expect("few links").candidates {
        let has_room = matches!(candidate.room, Room::Enough | Room::EnoughHere);
        assert!(has_room, "{candidate:?}");
        for robot in 0..10 {
            let here = candidate.placements.iter().filter(|it| it.robot == robot);
            assert!(here.count() <= 3, "{candidate:?}");
        }
    }
}
