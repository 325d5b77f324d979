//! Whether a secondary can take its component's place: it has every port that is connected, and
//! the same types there.

use system_model::rules::Secondary;
use system_model::specification::{ApplicationSpecification, PortReference};

use super::{AssemblyProblem, compare, compare_ports, find_port, list};
use crate::library::LoadedLibrary;

/// A secondary with its library.
pub(super) struct Candidate<'rules> {
    pub(super) rule: &'rules Secondary,
    pub(super) library: LoadedLibrary,
}

/// Compares every secondary with its own profile and with the component whose place it takes.
pub(super) fn check(
    specification: &ApplicationSpecification,
    primaries: &[LoadedLibrary],
    secondaries: &[Vec<Candidate<'_>>],
) -> Vec<AssemblyProblem> {
    let mut problems = Vec::new();
    for (component, candidates) in secondaries.iter().enumerate() {
        for candidate in candidates {
            problems.extend(compare_ports(
                &candidate.rule.specification,
                &candidate.library,
            ));
            let connected = specification
                .connections
                .iter()
                .flat_map(|connection| [&connection.source, &connection.target])
                .filter(|end| end.component == component);
            for end in connected {
                problems.extend(unfit(&primaries[component], candidate, end));
            }
        }
    }
    problems
}

fn unfit(
    primary: &LoadedLibrary,
    candidate: &Candidate<'_>,
    end: &PortReference,
) -> Option<AssemblyProblem> {
    let ours = find_port(&primary.description, &end.port)?;
    let theirs = find_port(&candidate.library.description, &end.port);
    let fits = theirs.is_some_and(|theirs| {
        (theirs.kind, theirs.direction) == (ours.kind, ours.direction)
            && compare::types(ours, theirs).is_none()
            && compare::methods(ours, theirs).is_none()
    });
    let secondary = &candidate.rule.specification;
    (!fits).then(|| AssemblyProblem::Connection {
        place: secondary.place.clone(),
        message: format!(
            "secondary '{}' cannot take the place of '{}': port '{}' is connected, and it has none \
             that fits",
            secondary.type_name, secondary.name, end.port
        ),
        help: format!(
            "it has {}",
            list(
                candidate
                    .library
                    .description
                    .ports
                    .iter()
                    .map(|port| &port.name)
            )
        ),
    })
}
