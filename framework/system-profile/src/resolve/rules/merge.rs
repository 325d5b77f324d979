//! Rules of several places made one: rule files win over inline elements, later inline elements over
//! earlier ones; rule files that contradict each other are an error that names both places.

mod combine;

use std::collections::HashMap;

use system_model::profile::Located;
use system_model::rules::{
    AdaptRule, ComponentRules, DependencyRule, ExecutorRules, FaultRule, HeartbeatRule,
    MonitorRule, PortChecks, VotingSpecification,
};
use system_model::specification::Place;

use super::names::Names;
use super::{dependencies, monitors};
use crate::problem::Severity;
use crate::readers::rules::{
    DeclaredApplication, DeclaredComponent, DeclaredExecutor, DeclaredRules, DeclaredSecondary,
};
use crate::resolve::Assembly;
use crate::suggest::quoted;
use combine::{Combine, Mode};

/// All rules of an application under their right names, ports and secondaries still to be looked at.
#[derive(Debug, Default)]
pub(super) struct Merged {
    pub(super) fault: Option<Located<FaultRule>>,
    pub(super) heartbeat: Option<Located<HeartbeatRule>>,
    pub(super) adapt: Option<Located<AdaptRule>>,
    /// One for each component of the application.
    pub(super) components: Vec<MergedComponent>,
    pub(super) executors: Vec<ExecutorRules>,
    pub(super) nodes: Vec<(String, Located<HeartbeatRule>)>,
    pub(super) dependencies: Vec<Located<DependencyRule>>,
    pub(super) monitors: Vec<MonitorRule>,
    pub(super) votings: Vec<VotingSpecification>,
}

/// The rules of one component.
#[derive(Debug, Default)]
pub(super) struct MergedComponent {
    pub(super) rules: ComponentRules,
    pub(super) ports: Vec<(Located<String>, PortChecks)>,
    pub(super) secondaries: Vec<DeclaredSecondary>,
}

/// Merges inline rules and those of all rule files.
pub(super) fn merge(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    inline: DeclaredRules,
    files: Vec<DeclaredRules>,
) -> Merged {
    let mut merged = gather(assembly, names, inline, Mode::Override);
    let mut of_files = empty(names);
    let exact = Combine::new(assembly, Mode::Conflict);
    for file in files {
        exact.all(&mut of_files, gather(assembly, names, file, Mode::Conflict));
    }
    Combine::new(assembly, Mode::Override).all(&mut merged, of_files);
    merged
}

fn empty(names: &Names<'_>) -> Merged {
    let components = names.application.components.iter();
    Merged {
        components: components.map(|_| MergedComponent::default()).collect(),
        ..Merged::default()
    }
}

/// The rules of one file, or all inline ones, with their names resolved.
fn gather(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    declared: DeclaredRules,
    mode: Mode,
) -> Merged {
    let mut merged = empty(names);
    let combine = Combine::new(assembly, mode);
    let mut places: HashMap<usize, Place> = HashMap::new();
    for component in declared.components {
        let Some(index) = names.component(assembly, &component.name) else {
            continue;
        };
        if let Some(first) = places.insert(index, component.place.clone())
            && mode == Mode::Conflict
        {
            report_twice(assembly, &component, &first);
        }
        combine.component(&mut merged.components[index], alone(component));
    }
    for executor in declared.executors {
        if let Some(executor) = resolved_executor(assembly, names, executor) {
            combine.executors(&mut merged.executors, vec![executor]);
        }
    }
    for (name, heartbeat) in declared.nodes {
        if names.node(assembly, &name) {
            combine.nodes(&mut merged.nodes, vec![(name.value, heartbeat)]);
        }
    }
    let mut all_dependencies = declared.dependencies;
    own_rules(assembly, &combine, &mut merged, declared.own);
    for mut application in declared.applications {
        let Some(name) = application.name.take() else {
            continue;
        };
        if !names.application(assembly, &name) {
            continue;
        }
        all_dependencies.append(&mut application.dependencies);
        if name.value == names.application.name {
            own_rules(assembly, &combine, &mut merged, application);
        } else {
            report_foreign(assembly, &name, &application);
        }
    }
    let dependencies = all_dependencies.iter();
    let dependencies = dependencies
        .filter_map(|dependency| dependencies::resolve(assembly, names, dependency))
        .collect();
    combine.dependencies(&mut merged.dependencies, dependencies);
    let monitors = declared.monitors.into_iter();
    let monitors = monitors
        .filter_map(|monitor| monitors::process_model(assembly, names, monitor))
        .collect();
    combine.monitors(&mut merged.monitors, monitors);
    let votings = declared.votings.into_iter();
    let votings = votings
        .filter_map(|voting| monitors::voting(assembly, names, voting))
        .collect();
    combine.votings(&mut merged.votings, votings);
    merged
}

fn alone(component: DeclaredComponent) -> MergedComponent {
    MergedComponent {
        rules: component.rules,
        ports: component.ports,
        secondaries: component.secondaries,
    }
}

fn own_rules(
    assembly: &Assembly<'_>,
    combine: &Combine<'_>,
    merged: &mut Merged,
    own: DeclaredApplication,
) {
    for secondary in &own.secondaries {
        assembly.report_at(
            Severity::Error,
            &secondary.reference.place,
            "a secondary of a whole application",
            "write it into the <fault> of the component that it stands in for",
        );
    }
    combine.slot("fault", &mut merged.fault, own.fault);
    combine.slot("heartbeat", &mut merged.heartbeat, own.heartbeat);
    combine.slot("adapt", &mut merged.adapt, own.adapt);
}

fn resolved_executor(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    executor: DeclaredExecutor,
) -> Option<ExecutorRules> {
    Some(ExecutorRules {
        first_component: names.executor(assembly, &executor.name)?,
        overrun: executor.overrun,
        heartbeat: executor.heartbeat,
    })
}

fn report_twice(assembly: &Assembly<'_>, component: &DeclaredComponent, first: &Place) {
    assembly.report_at(
        Severity::Error,
        &component.name.place,
        format!(
            "a second <component> of the name `{}`",
            quoted(&component.name.value)
        ),
        format!("write all its rules into the one at {first}"),
    );
}

fn report_foreign(
    assembly: &Assembly<'_>,
    name: &Located<String>,
    application: &DeclaredApplication,
) {
    let rules = [
        application.fault.is_some(),
        application.heartbeat.is_some(),
        application.adapt.is_some(),
    ];
    if rules.contains(&true) {
        assembly.report_at(
            Severity::Error,
            &name.place,
            format!("rules of another application, `{}`", quoted(&name.value)),
            "only its dependencies may stand here; write its rules into a file of its own",
        );
    }
}
