//! The dependency rules read a second time, as plainly as can be.

use fault_manager::Scope;
use system_model::rules::{DependencySeverity, Entity};
use system_model::specification::ExecutionKind;

/// How far a component is down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    Up,
    Stopped,
    Destroyed,
}

/// Global index of the first component of an application.
pub fn first(scopes: &[Scope], application: usize) -> usize {
    let before = scopes[..application].iter();
    before
        .map(|scope| scope.specification.components.len())
        .sum()
}

/// Everything that a rule of an application can name.
pub fn entities(scopes: &[Scope], application: usize) -> Vec<Entity> {
    let count = scopes[application].specification.components.len();
    let mut entities: Vec<Entity> = (0..count).map(Entity::Component).collect();
    entities.extend((0..count).map(Entity::Executor));
    let names = scopes.iter().map(|scope| scope.specification.name.clone());
    entities.extend(names.map(Entity::Application));
    entities
}

/// Global indices of the components of an entity, ascending.
pub fn members(scopes: &[Scope], application: usize, entity: &Entity) -> Vec<usize> {
    let base = first(scopes, application);
    let components = &scopes[application].specification.components;
    match entity {
        Entity::Component(index) => vec![base + index],
        Entity::Executor(leader) => {
            let kind = components[*leader].execution.kind;
            let shares = matches!(kind, ExecutionKind::PeriodicShared | ExecutionKind::Passive);
            let together = |index: &usize| {
                index == leader || (shares && components[*index].execution.kind == kind)
            };
            let all = 0..components.len();
            all.filter(together).map(|index| base + index).collect()
        }
        Entity::Application(name) => {
            let named = |scope: &Scope| scope.specification.name == *name;
            let other = scopes.iter().position(named).expect("it is one of them");
            let base = first(scopes, other);
            (base..base + scopes[other].specification.components.len()).collect()
        }
    }
}

/// For every component how far it must be down, given how far all are.
pub fn demanded(scopes: &[Scope], levels: &[Level]) -> Vec<Level> {
    let mut demanded = vec![Level::Up; levels.len()];
    for (application, scope) in scopes.iter().enumerate() {
        for rule in &scope.rules.dependencies {
            let rule = &rule.value;
            let level = match rule.severity {
                DependencySeverity::Ignore => continue,
                DependencySeverity::Stop => Level::Stopped,
                DependencySeverity::Destroy => Level::Destroyed,
            };
            let healthy = rule.providers.iter().filter(|provider| {
                let members = members(scopes, application, &provider.entity);
                let mut up = members.iter().map(|member| levels[*member] == Level::Up);
                match provider.entity {
                    Entity::Application(_) => up.any(|up| up),
                    Entity::Component(_) | Entity::Executor(_) => up.all(|up| up),
                }
            });
            if healthy.count() < rule.need {
                for member in members(scopes, application, &rule.dependent.entity) {
                    demanded[member] = demanded[member].max(level);
                }
            }
        }
    }
    demanded
}

/// Whether one component needs another, directly or through others.
pub fn needs(scopes: &[Scope], one: usize, other: usize) -> bool {
    let mut reached = vec![one];
    let mut next = 0;
    while let Some(component) = reached.get(next).copied() {
        next += 1;
        for (application, scope) in scopes.iter().enumerate() {
            for rule in &scope.rules.dependencies {
                let of = |entity: &Entity| members(scopes, application, entity);
                if of(&rule.value.dependent.entity).contains(&component) {
                    for provider in &rule.value.providers {
                        let new = of(&provider.entity);
                        reached.extend(
                            new.into_iter()
                                .filter(|one| !reached.contains(one))
                                .collect::<Vec<_>>(),
                        );
                    }
                }
            }
        }
    }
    one != other && reached.contains(&other)
}
