//! Is there a way to the target? A flood fill over the floor, obstacles grown by half a corridor.

use std::collections::VecDeque;

use system_model::world::{Position, WorldSpecification};

use crate::arena::{Arena, SolidKind};
use crate::geometry::distance_m;

/// A tenth of the corridor of the reference arena: no gap that matters falls between two cells.
const CELL_M: f64 = 0.05;

/// Whether a way `corridor_m` wide leads from the start to within reach of the target.
pub(crate) fn leads_to_target(world: &WorldSpecification, arena: &Arena, corridor_m: f64) -> bool {
    let floor = Floor::new(world, arena, corridor_m / 2.0);
    let goal_radius_m = world.target.radius_m
        + world.target.reach_distance_m
        + (world.robot.length_m / 2.0).max(corridor_m / 2.0);
    let Some(start) = floor.cell_of(world.robot.start.position) else {
        return false;
    };
    let mut seen = vec![false; floor.columns * floor.rows];
    let mut waiting = VecDeque::new();
    if floor.is_free(start) {
        seen[floor.index(start)] = true;
        waiting.push_back(start);
    }
    while let Some(cell) = waiting.pop_front() {
        if distance_m(Floor::centre(cell), arena.target) <= goal_radius_m {
            return true;
        }
        for next in floor.neighbours(cell) {
            let index = floor.index(next);
            if !seen[index] && floor.is_free(next) {
                seen[index] = true;
                waiting.push_back(next);
            }
        }
    }
    false
}

/// Column and row.
type Cell = (usize, usize);

struct Floor<'a> {
    arena: &'a Arena,
    clearance_m: f64,
    columns: usize,
    rows: usize,
}

impl<'a> Floor<'a> {
    fn new(world: &WorldSpecification, arena: &'a Arena, clearance_m: f64) -> Self {
        let cells = |size_m: f64| (size_m / CELL_M) as usize;
        Self {
            arena,
            clearance_m,
            columns: cells(world.arena.length_m),
            rows: cells(world.arena.width_m),
        }
    }

    fn cell_of(&self, position: Position) -> Option<Cell> {
        let Position { x_m, y_m } = position;
        let cell = ((x_m / CELL_M) as usize, (y_m / CELL_M) as usize);
        let inside = x_m >= 0.0 && y_m >= 0.0 && cell.0 < self.columns && cell.1 < self.rows;
        inside.then_some(cell)
    }

    fn centre((column, row): Cell) -> Position {
        Position {
            x_m: (column as f64 + 0.5) * CELL_M,
            y_m: (row as f64 + 0.5) * CELL_M,
        }
    }

    fn index(&self, (column, row): Cell) -> usize {
        row * self.columns + column
    }

    /// The target itself does not bar the way to it.
    fn is_free(&self, cell: Cell) -> bool {
        let centre = Self::centre(cell);
        self.arena
            .solids
            .iter()
            .filter(|solid| solid.kind != SolidKind::Target)
            .all(|solid| solid.outline.distance_m(centre) >= self.clearance_m)
    }

    fn neighbours(&self, (column, row): Cell) -> impl Iterator<Item = Cell> + use<'_, 'a> {
        [
            (column.wrapping_sub(1), row),
            (column + 1, row),
            (column, row.wrapping_sub(1)),
            (column, row + 1),
        ]
        .into_iter()
        .filter(|&(column, row)| column < self.columns && row < self.rows)
    }
}
