//! Which components run together, as the container groups them.

use system_model::specification::{ComponentSpecification, ExecutionKind};

/// The first component of the executor that runs a component; an executor bears its name.
pub(super) fn executor_of(components: &[ComponentSpecification], index: usize) -> usize {
    let own = &components[index].execution;
    let runs_together = |other: &ComponentSpecification| {
        let other = &other.execution;
        other.kind == own.kind
            && match own.kind {
                ExecutionKind::PeriodicShared => {
                    (other.period, other.priority, other.policy)
                        == (own.period, own.priority, own.policy)
                }
                ExecutionKind::Passive => true,
                ExecutionKind::Periodic | ExecutionKind::Aperiodic => false,
            }
    };
    let first = components[..index].iter().position(runs_together);
    first.unwrap_or(index)
}
