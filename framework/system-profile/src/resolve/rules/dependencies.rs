//! Who needs whom: names, redundancy, and circles.

use std::collections::HashSet;

use system_model::profile::Located;
use system_model::rules::{DependencyRule, Entity, Provider};

use super::names::Names;
use crate::problem::Severity;
use crate::readers::rules::DeclaredDependency;
use crate::resolve::Assembly;
use crate::suggest::quoted;

/// Circles that have no dependency in common are reported together, but not without end.
const MAX_CIRCLES: usize = 10;

/// A dependency with its names resolved; none if one of them is unknown.
pub(super) fn resolve(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    declared: &DeclaredDependency,
) -> Option<Located<DependencyRule>> {
    let dependent = names.entity(assembly, &declared.dependent);
    let mut providers: Vec<Provider> = Vec::new();
    let mut unknown = false;
    for reference in &declared.references {
        match names.entity(assembly, reference) {
            Some(provider) if providers.contains(&provider) => assembly.report_at(
                Severity::Error,
                &reference.name.place,
                format!("`{}` is a provider already", quoted(&provider.name)),
                "it can be lost only once; name each provider once",
            ),
            Some(provider) => providers.push(provider),
            None => unknown = true,
        }
    }
    if declared.need > declared.references.len() {
        assembly.report_at(
            Severity::Error,
            &declared.place,
            format!(
                "{} providers are needed of {}",
                declared.need,
                declared.references.len()
            ),
            "the dependency is broken from the beginning; write need=\"1\" or more references",
        );
        return None;
    }
    let rule = DependencyRule {
        dependent: dependent?,
        providers,
        need: declared.need,
        severity: declared.severity,
    };
    (!unknown).then(|| Located {
        value: rule,
        place: declared.place.clone(),
    })
}

/// One step of a circle: an entity, the next one that it needs, and the number of the dependency
/// that says so.
type Step<'d> = (&'d Provider, &'d Provider, usize);

/// Reports who would, through others, need itself.
pub(super) fn check(assembly: &Assembly<'_>, dependencies: &[Located<DependencyRule>]) {
    let mut steps: Vec<Step<'_>> = dependencies
        .iter()
        .enumerate()
        .flat_map(|(number, rule)| {
            let providers = rule.value.providers.iter();
            providers.map(move |provider| (&rule.value.dependent, provider, number))
        })
        .collect();
    for _ in 0..MAX_CIRCLES {
        let Some(mut circle) = find_circle(&steps) else {
            return;
        };
        // The youngest dependency closes it: one of a rule file, before an inline one.
        let numbers = circle.iter().map(|step| step.2).enumerate();
        let youngest = numbers.max_by_key(|(_, number)| *number);
        circle.rotate_left(youngest.map_or(0, |(position, _)| position));
        report(assembly, &circle, dependencies);
        let of_circle: Vec<_> = circle
            .iter()
            .map(|step| (&step.0.entity, &step.1.entity))
            .collect();
        steps.retain(|step| !of_circle.contains(&(&step.0.entity, &step.1.entity)));
    }
}

/// Steps that lead to an entity that needs nobody are taken away until none is left, or only those
/// of circles and what leads into them; from there every step must return.
fn find_circle<'d>(all: &[Step<'d>]) -> Option<Vec<Step<'d>>> {
    let mut steps = all.to_vec();
    loop {
        let needing: HashSet<&Entity> = steps.iter().map(|step| &step.0.entity).collect();
        let before = steps.len();
        let leads_on: Vec<bool> = steps
            .iter()
            .map(|step| needing.contains(&step.1.entity))
            .collect();
        let mut kept = leads_on.into_iter();
        steps.retain(|_| kept.next().unwrap_or(false));
        if steps.len() == before {
            break;
        }
    }
    let mut path: Vec<Step<'d>> = Vec::new();
    let mut current = &steps.first()?.0.entity;
    loop {
        if let Some(start) = path.iter().position(|step| step.0.entity == *current) {
            return Some(path.split_off(start));
        }
        let next = steps.iter().find(|step| step.0.entity == *current)?;
        path.push(*next);
        current = &next.1.entity;
    }
}

fn report(assembly: &Assembly<'_>, circle: &[Step<'_>], dependencies: &[Located<DependencyRule>]) {
    let Some((_, _, number)) = circle.first() else {
        return;
    };
    let names: Vec<String> = circle
        .iter()
        .chain(circle.first())
        .map(|(dependent, ..)| quoted(&dependent.name))
        .collect();
    assembly.report_at(
        Severity::Error,
        &dependencies[*number].place,
        format!("a circular dependency: {}", names.join(" needs ")),
        "when one stops all would stop, and none could be the cause; remove one of these",
    );
}
