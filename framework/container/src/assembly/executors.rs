//! Which components run together.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, ExecutionKind,
};

use crate::component::ComponentCell;
use crate::executor::{Executor, Member};
use crate::wake::Wake;

/// Puts every component into its executor: a thread of its own; one that it shares with components
/// of the same period and priority; or the one in which all passive components get their events.
/// Components share only with those of their own application, of which each begins at one of
/// `firsts`.
pub(super) fn group(
    specification: &ApplicationSpecification,
    firsts: &[usize],
    components: &[Arc<ComponentCell>],
) -> Vec<Executor> {
    let mut executors: Vec<Executor> = Vec::new();
    for (index, component) in specification.components.iter().enumerate() {
        let number = u32::try_from(index).unwrap_or(u32::MAX);
        let shared = executors.iter().position(|executor| {
            let leader = executor.members.first();
            let is_near = leader.is_some_and(|leader| {
                !firsts.iter().any(|first| {
                    let first = u32::try_from(*first).unwrap_or(u32::MAX);
                    leader.number < first && first <= number
                })
            });
            is_near && runs_with(executor, component)
        });
        let position = shared.unwrap_or_else(|| {
            executors.push(executor_for(component));
            executors.len() - 1
        });
        executors[position].members.push(Member {
            component: Arc::clone(&components[index]),
            number,
            triggers: Vec::new(),
            followers: Vec::new(),
        });
    }
    coordinate(specification, &mut executors);
    executors
}

fn runs_with(executor: &Executor, component: &ComponentSpecification) -> bool {
    let execution = &component.execution;
    executor.kind == execution.kind
        && match execution.kind {
            ExecutionKind::PeriodicShared => {
                executor.period == execution.period
                    && executor.priority == execution.priority
                    && executor.policy == execution.policy
            }
            ExecutionKind::Passive => true,
            ExecutionKind::Periodic | ExecutionKind::Aperiodic => false,
        }
}

fn executor_for(component: &ComponentSpecification) -> Executor {
    let execution = &component.execution;
    let period = match execution.kind {
        ExecutionKind::Periodic | ExecutionKind::PeriodicShared => execution.period,
        ExecutionKind::Passive | ExecutionKind::Aperiodic => Duration::ZERO,
    };
    Executor::new(
        component.name.clone(),
        execution.kind,
        period,
        execution.priority,
        execution.policy,
        Arc::new(Wake::default()),
    )
}

/// `coordination/depends`: the source runs only in cycles after the target has run.
fn coordinate(specification: &ApplicationSpecification, executors: &mut [Executor]) {
    for (source, target) in &specification.coordination {
        let fired = Arc::new(AtomicBool::new(false));
        for member in executors
            .iter_mut()
            .flat_map(|executor| &mut executor.members)
        {
            let number = usize::try_from(member.number).unwrap_or(usize::MAX);
            if number == *source {
                member.triggers.push(Arc::clone(&fired));
            }
            if number == *target {
                member.followers.push(Arc::clone(&fired));
            }
        }
    }
}
