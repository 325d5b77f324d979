//! Applications from numbers.

use std::path::PathBuf;
use std::time::Duration;

use fault_manager::Scope;
use system_model::rules::{
    ComponentRules, DependencyRule, DependencySeverity, Entity, FaultRules, Provider,
};
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, ConnectionSpecification, ExecutionKind,
    ExecutionSemantics, Place, PortKind, PortReference, SchedulingPolicy,
};

use crate::generators::located;

pub fn component(name: &str, kind: u8) -> ComponentSpecification {
    ComponentSpecification {
        name: name.to_owned(),
        type_name: name.to_owned(),
        profile: PathBuf::new(),
        place: Place::default(),
        library: String::new(),
        execution: ExecutionSemantics {
            kind: match kind {
                0 => ExecutionKind::Periodic,
                1 => ExecutionKind::PeriodicShared,
                2 => ExecutionKind::Passive,
                _ => ExecutionKind::Aperiodic,
            },
            period: Duration::from_millis(20),
            priority: 0,
            policy: SchedulingPolicy::Other,
        },
        properties: Vec::new(),
        ports: Vec::new(),
        node: String::new(),
    }
}

pub fn application(name: &str, rules: &[ComponentRules], kinds: &[u8]) -> Scope {
    let components = kinds.iter().enumerate();
    let named = components.map(|(index, kind)| component(&format!("{name}_{index}"), *kind));
    Scope {
        specification: ApplicationSpecification {
            name: name.to_owned(),
            file: PathBuf::new(),
            components: named.collect(),
            connections: Vec::new(),
            manager_connections: Vec::new(),
            coordination: Vec::new(),
            world: None,
            trees: Vec::new(),
        },
        rules: FaultRules {
            application: name.to_owned(),
            components: rules.to_vec(),
            ..FaultRules::default()
        },
    }
}

pub fn connect(scope: &mut Scope, connections: &[(usize, usize)]) {
    let count = scope.specification.components.len();
    let end = |component: usize, port: &str| PortReference {
        component: component % count,
        port: port.to_owned(),
    };
    let made = connections
        .iter()
        .map(|(source, target)| ConnectionSpecification {
            kind: PortKind::Data,
            source: end(*source, "output"),
            target: end(*target, "input"),
            place: Place::default(),
        });
    scope.specification.connections = made.collect();
}

/// Adds a dependency without making a circle: the dependent lies before all that it needs, or behind
/// all of it where the order is backwards.
pub fn depend(scopes: &mut [Scope], wanted: (usize, Vec<usize>, usize, u8), backwards: bool) {
    let (dependent, providers, need, severity) = wanted;
    let owner = dependent % scopes.len();
    let entities = crate::oracle::entities(scopes, owner);
    let members = |entity: &Entity| crate::oracle::members(scopes, owner, entity);
    let dependent = entities[dependent % entities.len()].clone();
    let own = members(&dependent);
    let apart = |provider: &Entity| {
        let others = members(provider);
        if backwards {
            own.first() > others.last()
        } else {
            own.last() < others.first()
        }
    };
    let mut providers: Vec<Entity> = providers
        .into_iter()
        .map(|index| entities[index % entities.len()].clone())
        .filter(apart)
        .collect();
    providers.dedup();
    if providers.is_empty() {
        return;
    }
    let named = |entity: Entity| Provider {
        name: format!("{entity:?}"),
        entity,
    };
    let rule = DependencyRule {
        dependent: named(dependent),
        need: need.min(providers.len()),
        providers: providers.into_iter().map(named).collect(),
        severity: match severity {
            0 => DependencySeverity::Ignore,
            1 => DependencySeverity::Stop,
            _ => DependencySeverity::Destroy,
        },
    };
    scopes[owner].rules.dependencies.push(located(rule));
}
