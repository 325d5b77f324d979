//! Drawn arenas keep their promises.

use robot_simulation::{Outline, Simulation, SimulationError, SolidKind};
use system_model::world::{
    ObstacleShape, Position, RandomObstacleSpecification, WallSpecification, WorldSpecification,
};

use crate::driver::empty_world;

fn circles(simulation: &Simulation) -> Vec<(Outline, f64)> {
    let obstacles = simulation
        .arena()
        .solids
        .iter()
        .filter(|s| s.kind == SolidKind::Obstacle);
    obstacles
        .map(|solid| match solid.outline.shape {
            ObstacleShape::Circle { radius_m } => (solid.outline, radius_m),
            ObstacleShape::Box { .. } => panic!("random obstacles are round"),
        })
        .collect()
}

#[test]
fn a_hundred_seeds_give_arenas_with_room_to_drive() {
    let world = WorldSpecification::default();
    let rules = RandomObstacleSpecification::default();
    for seed in 0..100 {
        let simulation = Simulation::new(&world, seed).expect("an arena");
        let obstacles = circles(&simulation);
        assert!((rules.count_minimum..=rules.count_maximum).contains(&obstacles.len()));
        for (index, (outline, radius_m)) in obstacles.iter().enumerate() {
            let Position { x_m, y_m } = outline.centre;
            let to_wall_m = x_m.min(y_m).min(6.0 - x_m).min(4.0 - y_m) - radius_m;
            assert!(
                to_wall_m >= rules.gap_m - 1e-9,
                "seed {seed}: {to_wall_m} m to a wall"
            );
            let start_m = outline.distance_m(world.robot.start.position);
            assert!(start_m >= rules.keep_out_robot_m, "seed {seed}");
            let target_m = outline.distance_m(simulation.arena().target);
            assert!(target_m >= rules.keep_out_target_m, "seed {seed}");
            for (other, _) in &obstacles[..index] {
                assert!(
                    other.distance_m(outline.centre) - radius_m >= rules.gap_m,
                    "seed {seed}"
                );
            }
        }
    }
}

#[test]
fn different_seeds_draw_different_arenas() {
    let world = WorldSpecification::default();
    let arena = |seed| {
        Simulation::new(&world, seed)
            .expect("an arena")
            .arena()
            .clone()
    };
    assert_eq!(arena(1), arena(1));
    assert_ne!(arena(1), arena(2));
}

#[test]
fn a_wall_across_the_arena_is_refused_and_a_gate_in_it_accepted() {
    let wall = |from_y_m, to_y_m| WallSpecification {
        from: Position {
            x_m: 4.0,
            y_m: from_y_m,
        },
        to: Position {
            x_m: 4.0,
            y_m: to_y_m,
        },
        thickness_m: 0.1,
    };
    let mut world = empty_world();
    world.walls.push(wall(0.0, 4.0));
    let refusal = Simulation::new(&world, 1).err();
    assert!(
        matches!(refusal, Some(SimulationError::NoWayToTarget { .. })),
        "{refusal:?}"
    );
    // The ends of the wall stand half a thickness out.
    for (gate_m, open) in [(0.4, false), (0.8, true)] {
        world.walls = vec![wall(0.0, 1.0), wall(1.1 + gate_m, 4.0)];
        assert_eq!(
            Simulation::new(&world, 1).is_ok(),
            open,
            "a gate {gate_m} m wide"
        );
    }
}
