//! The arena of one run: every solid in its place, random ones drawn from the seed.

use rand::RngExt;
use rand_pcg::Pcg64;
use system_model::world::{
    ArenaSpecification, BandSpecification, Colour, ObstacleShape, Position,
    RandomObstacleSpecification, TargetPlace, WallSpecification, WorldSpecification,
};

use crate::error::SimulationError;
use crate::geometry::{Outline, distance_m};
use crate::passage::leads_to_target;
use crate::random::{Purpose, stream};

/// Arenas drawn before a world is given up. Sensible worlds succeed within a few.
const ARENA_TRIES: usize = 200;
/// Places drawn for one obstacle before the whole arena is drawn again.
const PLACE_TRIES: usize = 200;
/// Width of the way to the target where no random obstacles say another.
const CORRIDOR_M: f64 = 0.5;
/// Thick enough that no step of the physics jumps through.
const OUTER_WALL_THICKNESS_M: f64 = 0.2;

/// What a solid is to the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolidKind {
    /// An outer or inner wall.
    Wall,
    /// Something to drive around.
    Obstacle,
    /// What the robot looks for.
    Target,
}

/// Something that stands on the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solid {
    /// What it is.
    pub kind: SolidKind,
    /// The floor it covers.
    pub outline: Outline,
    /// Height in m.
    pub height_m: f64,
    /// Colour.
    pub colour: Colour,
}

/// All solids of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Arena {
    /// Walls, obstacles and, last, the target.
    pub solids: Vec<Solid>,
    /// Centre of the target.
    pub target: Position,
    /// Bands around the target.
    pub target_bands: Option<BandSpecification>,
    /// Height of the outer walls in m.
    pub wall_height_m: f64,
}

impl Arena {
    /// Draws the arena of the run with this seed; in it a way at least as wide as the obstacles'
    /// gap leads from the robot to the target.
    pub(crate) fn draw(world: &WorldSpecification, seed: u64) -> Result<Self, SimulationError> {
        let mut random = stream(seed, Purpose::Arena);
        let corridor_m = world
            .random_obstacles
            .map_or(CORRIDOR_M, |obstacles| obstacles.gap_m);
        (0..ARENA_TRIES)
            .filter_map(|_| draw_once(world, &mut random))
            .find(|arena| leads_to_target(world, arena, corridor_m))
            .ok_or_else(|| SimulationError::NoWayToTarget {
                world: world.name.clone(),
                tries: ARENA_TRIES,
                corridor_m,
            })
    }

    /// The target goes to another place; it is the last solid.
    pub(crate) fn move_target(&mut self, to: Position) {
        self.target = to;
        if let Some(target) = self.solids.last_mut() {
            target.outline.centre = to;
        }
    }
}

/// One arena, or none when an obstacle found no place.
fn draw_once(world: &WorldSpecification, random: &mut Pcg64) -> Option<Arena> {
    let mut solids = outer_walls(&world.arena);
    solids.extend(
        world
            .walls
            .iter()
            .map(|wall| wall_solid(wall, &world.arena)),
    );
    solids.extend(world.obstacles.iter().map(|obstacle| Solid {
        kind: SolidKind::Obstacle,
        outline: Outline {
            centre: obstacle.centre,
            shape: obstacle.shape,
        },
        height_m: obstacle.height_m,
        colour: obstacle.colour,
    }));
    let target = draw_target(world.target.place, random);
    if let Some(obstacles) = &world.random_obstacles {
        let count = random.random_range(obstacles.count_minimum..=obstacles.count_maximum);
        for _ in 0..count {
            let outline = place_obstacle(world, obstacles, &solids, target, random)?;
            solids.push(Solid {
                kind: SolidKind::Obstacle,
                outline,
                height_m: obstacles.height_m,
                colour: obstacles.colour,
            });
        }
    }
    solids.push(Solid {
        kind: SolidKind::Target,
        outline: Outline::circle(target, world.target.radius_m),
        height_m: world.target.height_m,
        colour: world.target.colour,
    });
    Some(Arena {
        solids,
        target,
        target_bands: world.target.bands,
        wall_height_m: world.arena.wall_height_m,
    })
}

fn draw_target(place: TargetPlace, random: &mut Pcg64) -> Position {
    match place {
        TargetPlace::Fixed(position) => position,
        TargetPlace::Region { lowest, highest } => Position {
            x_m: random.random_range(lowest.x_m..=highest.x_m),
            y_m: random.random_range(lowest.y_m..=highest.y_m),
        },
    }
}

fn place_obstacle(
    world: &WorldSpecification,
    obstacles: &RandomObstacleSpecification,
    solids: &[Solid],
    target: Position,
    random: &mut Pcg64,
) -> Option<Outline> {
    (0..PLACE_TRIES).find_map(|_| {
        let radius_m = random.random_range(obstacles.radius_minimum_m..=obstacles.radius_maximum_m);
        let centre = Position {
            x_m: random.random_range(0.0..=world.arena.length_m),
            y_m: random.random_range(0.0..=world.arena.width_m),
        };
        let start = world.robot.start.position;
        let fits = distance_m(centre, start) - radius_m >= obstacles.keep_out_robot_m
            && distance_m(centre, target) - radius_m >= obstacles.keep_out_target_m
            && solids
                .iter()
                .all(|solid| solid.outline.distance_m(centre) - radius_m >= obstacles.gap_m);
        fits.then(|| Outline::circle(centre, radius_m))
    })
}

fn outer_walls(arena: &ArenaSpecification) -> Vec<Solid> {
    let ArenaSpecification {
        length_m, width_m, ..
    } = *arena;
    let outside = OUTER_WALL_THICKNESS_M / 2.0;
    let corner = |x_m, y_m| Position { x_m, y_m };
    [
        (
            corner(-outside, -outside),
            corner(length_m + outside, -outside),
        ),
        (
            corner(length_m + outside, -outside),
            corner(length_m + outside, width_m + outside),
        ),
        (
            corner(length_m + outside, width_m + outside),
            corner(-outside, width_m + outside),
        ),
        (
            corner(-outside, width_m + outside),
            corner(-outside, -outside),
        ),
    ]
    .map(|(from, to)| {
        let wall = WallSpecification {
            from,
            to,
            thickness_m: OUTER_WALL_THICKNESS_M,
        };
        wall_solid(&wall, arena)
    })
    .to_vec()
}

fn wall_solid(wall: &WallSpecification, arena: &ArenaSpecification) -> Solid {
    let WallSpecification {
        from,
        to,
        thickness_m,
    } = *wall;
    let centre = Position {
        x_m: (from.x_m + to.x_m) / 2.0,
        y_m: (from.y_m + to.y_m) / 2.0,
    };
    let shape = ObstacleShape::Box {
        // Half a thickness beyond each end, so that walls that meet leave no notch.
        length_m: distance_m(from, to) + thickness_m,
        width_m: thickness_m,
        heading_rad: libm::atan2(to.y_m - from.y_m, to.x_m - from.x_m),
    };
    Solid {
        kind: SolidKind::Wall,
        outline: Outline { centre, shape },
        height_m: arena.wall_height_m,
        colour: arena.wall_colour,
    }
}
