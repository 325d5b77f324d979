//! The last step: ports, secondaries and limits of merged rules.

use system_model::mission::TreeStart;
use system_model::profile::Located;
use system_model::rules::{ComponentRules, FaultRules};
use system_model::specification::{PortDirection, PortKind};

use super::merge::{Merged, MergedComponent};
use super::names::{Names, description};
use super::{dependencies, limits, port_checks, secondaries};
use crate::problem::Severity;
use crate::resolve::Assembly;
use crate::suggest::{self, quoted};

/// Makes the rules of the application, and reports what is wrong with the whole of them.
pub(super) fn finish(assembly: &mut Assembly<'_>, names: &Names<'_>, merged: Merged) -> FaultRules {
    dependencies::check(assembly, &merged.dependencies);
    let components = merged.components.into_iter().enumerate();
    let components: Vec<ComponentRules> = components
        .map(|(index, component)| finish_component(assembly, names, index, component))
        .collect();
    let rules = FaultRules {
        application: names.application.name.clone(),
        fault: merged.fault,
        heartbeat: merged.heartbeat,
        adapt: merged.adapt,
        components,
        executors: merged.executors,
        nodes: merged.nodes,
        dependencies: merged.dependencies,
        monitors: merged.monitors,
        votings: merged.votings,
    };
    limits::check(assembly, names, &rules);
    rules
}

fn finish_component(
    assembly: &mut Assembly<'_>,
    names: &Names<'_>,
    index: usize,
    merged: MergedComponent,
) -> ComponentRules {
    let mut rules = merged.rules;
    rules.ports = port_checks::resolve(assembly, names, index, merged.ports);
    check_fault_events(assembly, names, index, &rules);
    check_handle(assembly, names, &rules);
    rules.secondaries = secondaries::resolve(assembly, names, index, &merged.secondaries);
    rules
}

fn check_fault_events(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    index: usize,
    rules: &ComponentRules,
) {
    for event in &rules.fault_events {
        let Some(port) = &event.value.port else {
            continue;
        };
        let name = Located {
            value: port.clone(),
            place: event.place.clone(),
        };
        let port = names.port(assembly, index, &name);
        if let Some(port) = port
            .filter(|port| port.kind != PortKind::Event || port.direction != PortDirection::Output)
        {
            assembly.report_at(
                Severity::Error,
                &event.place,
                format!(
                    "the port {} is {}, not an output event port",
                    quoted(&port.name),
                    description(port)
                ),
                "name an output event port, or no port for faults that are reported to the container",
            );
        }
    }
}

/// A fault can only be handled by a tree that waits for that.
fn check_handle(assembly: &Assembly<'_>, names: &Names<'_>, rules: &ComponentRules) {
    let Some(handle) = &rules.handle else { return };
    // A profile that is checked by itself belongs to no application yet.
    if names.application.name.is_empty() {
        return;
    }
    let name = &handle.value.tree;
    let trees = &names.application.trees;
    let (message, help) = match trees.iter().find(|tree| tree.name == *name) {
        Some(tree) if tree.starts == TreeStart::ByFault => return,
        Some(tree) => (
            format!("the tree {} is ticked from the start", quoted(name)),
            format!("write starts=\"by_fault\" at {}", tree.place),
        ),
        None => {
            let known = trees.iter().map(|tree| tree.name.as_str());
            let help = suggest::help(name, "its trees are", known);
            (
                format!("the application has no tree {}", quoted(name)),
                help.unwrap_or_else(|| "declare it by <tree> in the application".to_owned()),
            )
        }
    };
    assembly.report_at(Severity::Error, &handle.place, message, &help);
}
