//! Puts the fault manager in charge of an assembled application.

use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::Receiver;
use fault_manager::{DetectorKind, FaultManager, Scope};
use system_model::rules::FaultRules;
use system_model::specification::ApplicationSpecification;

use crate::assembly::Assembly;
use crate::component::{ComponentCell, Detectors, Environment};
use crate::lane::SETUP_TOKEN;
use crate::supervision::{Emergency, Orders, Standbys, Supervisor};

/// The shell around the application's fault manager, and the channel by which it asks for standbys.
pub(super) fn supervise(
    specification: &ApplicationSpecification,
    rules: &FaultRules,
    assembly: &Assembly,
    environment: &Arc<Environment>,
) -> (Supervisor, Receiver<usize>) {
    let manager = FaultManager::new(vec![Scope {
        specification: specification.clone(),
        rules: rules.clone(),
    }]);
    for (index, cell) in assembly.components.iter().enumerate() {
        instrument(index, cell, rules, &manager);
    }
    let orders = (0..assembly.components.len())
        .map(|index| orders_of(assembly, index))
        .collect();
    let standbys = assembly
        .factories
        .iter()
        .map(|factory| Standbys::new(Arc::clone(factory)))
        .collect();
    Supervisor::new(
        Arc::clone(environment),
        manager,
        orders,
        standbys,
        Emergency::default(),
    )
}

fn instrument(index: usize, cell: &ComponentCell, rules: &FaultRules, manager: &FaultManager) {
    let Some(mut component) = cell.enter(SETUP_TOKEN, Duration::ZERO) else {
        return;
    };
    let find = |kind| manager.detector(index, &kind);
    if let (Some(exception), Some(hang), Some(reported)) = (
        find(DetectorKind::Exception),
        find(DetectorKind::Hang),
        find(DetectorKind::FaultEvent(None)),
    ) {
        component.services_mut().set_detectors(Detectors {
            component: index,
            exception,
            hang,
            reported,
        });
    }
    let backup = rules
        .components
        .get(index)
        .and_then(|rules| rules.resurrect.as_ref()?.value.backup);
    if let Some(period) = backup {
        component.keep_checkpoints(period);
    }
}

fn orders_of(assembly: &Assembly, component: usize) -> Arc<Orders> {
    let runs = |member: &crate::executor::Member| usize::try_from(member.number) == Ok(component);
    let executor = assembly
        .executors
        .iter()
        .find(|executor| executor.members.iter().any(runs));
    // Every component is in an executor; one without would take no orders, and say so.
    executor.map_or_else(
        || Arc::new(Orders::new(Arc::default())),
        |executor| Arc::clone(&executor.orders),
    )
}
