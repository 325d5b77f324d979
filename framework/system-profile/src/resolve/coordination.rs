//! `coordination/depends`: who runs only after whom, without going round in circles.

use std::collections::HashSet;
use std::rc::Rc;

use system_model::profile::{CoordinationRule, Located};
use system_model::specification::ComponentSpecification;

use super::instances::{Member, Scope};
use super::{Assembly, LoadedFile};
use crate::problem::Severity;
use crate::suggest::quoted;

/// One component that waits for another, and where that was declared.
#[derive(Debug)]
pub(super) struct Edge {
    pub(super) ends: (usize, usize),
    file: Rc<LoadedFile>,
    rule: Located<String>,
}

impl Assembly<'_> {
    /// Resolves the rules of one file. A composite stands for all of its components.
    pub(super) fn coordinate(&mut self, scope: &Scope, rules: &[CoordinationRule]) {
        let mut known: HashSet<(&str, &str)> = HashSet::new();
        for rule in rules {
            if scope.file.document.is_given_up() {
                return;
            }
            let source = scope.member(&rule.source).map(components);
            let target = scope.member(&rule.target).map(components);
            let (Some(source), Some(target)) = (source, target) else {
                continue;
            };
            if !known.insert((&rule.source.value, &rule.target.value)) {
                scope.file.document.report(
                    Severity::Warning,
                    &rule.source,
                    "this rule was already given",
                    Some("remove one of them".into()),
                );
                continue;
            }
            let pairs =
                source.flat_map(|waiting| target.clone().map(move |first| (waiting, first)));
            self.edges.extend(pairs.map(|ends| Edge {
                ends,
                file: Rc::clone(&scope.file),
                rule: rule.source.clone(),
            }));
        }
    }
}

fn components(member: &Member) -> std::ops::Range<usize> {
    match member {
        Member::Component(index) => *index..*index + 1,
        Member::Composite(composite) => composite.components.clone(),
        Member::Unknown => 0..0,
    }
}

/// Reports one circle, if the rules make any.
pub(super) fn check(edges: &[Edge], components: &[ComponentSpecification]) {
    let Some(circle) = find_circle(edges, components.len()) else {
        return;
    };
    let names: Vec<String> = circle
        .iter()
        .chain(circle.first())
        .map(|edge| quoted(&components[edge.ends.0].name))
        .collect();
    let Some(first) = circle.first() else {
        return;
    };
    first.file.document.report(
        Severity::Error,
        &first.rule,
        format!("components wait for each other: {}", names.join(" after ")),
        Some("none of them would ever run; remove one of these rules".into()),
    );
}

/// Components that wait for nobody are taken away until none is left, or only circles and what
/// waits for them; from there every step to what is waited for stays inside, so it must return.
fn find_circle(edges: &[Edge], count: usize) -> Option<Vec<&Edge>> {
    let mut waits = vec![0_usize; count];
    let mut waited_for_by = vec![Vec::new(); count];
    for edge in edges {
        let (waiting, first) = edge.ends;
        waits[waiting] += 1;
        waited_for_by[first].push(waiting);
    }
    let mut free: Vec<usize> = (0..count).filter(|index| waits[*index] == 0).collect();
    while let Some(index) = free.pop() {
        for &waiting in &waited_for_by[index] {
            waits[waiting] -= 1;
            if waits[waiting] == 0 {
                free.push(waiting);
            }
        }
    }
    let stuck = |index: usize| waits[index] > 0;
    let mut path: Vec<&Edge> = Vec::new();
    let mut current = (0..count).find(|index| stuck(*index))?;
    loop {
        if let Some(start) = path.iter().position(|edge| edge.ends.0 == current) {
            return Some(path.split_off(start));
        }
        let next = edges
            .iter()
            .find(|edge| edge.ends.0 == current && stuck(edge.ends.1))?;
        path.push(next);
        current = next.ends.1;
    }
}
