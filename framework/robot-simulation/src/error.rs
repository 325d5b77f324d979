//! Why a world cannot be driven in.

/// Why [`Simulation::new`](crate::Simulation::new) refuses a world.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// No arena with a comfortable way from the start to the target was found.
    #[error(
        "world '{world}': in {tries} drawn arenas no way {corridor_m:.2} m wide leads from the \
         robot to the target; use fewer or smaller obstacles, or a smaller gap"
    )]
    NoWayToTarget {
        /// Name of the world.
        world: String,
        /// Number of arenas drawn.
        tries: usize,
        /// Width that was asked for.
        corridor_m: f64,
    },
}
