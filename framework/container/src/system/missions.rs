//! Behaviour trees of all applications, bound to their components.

use std::sync::Arc;

use super::StartError;
use super::applications::{Applications, Part};
use crate::assembly::Assembly;
use crate::mission::{Calls, Ground, Outlets, Reach, Runner, bind};
use crate::supervision::Supervisor;

/// The trees, in the order in which the fault manager counts them behind all components, and what they
/// will ask of services. In a
/// recording that is played nothing is ordered, so there are none.
///
/// # Errors
/// What does not fit the libraries.
pub(super) fn bind_all(
    applications: &Applications,
    assembly: &Assembly,
    supervisor: &Arc<Supervisor>,
) -> Result<(Vec<Runner>, Arc<Calls>), StartError> {
    let calls = Arc::default();
    if supervisor.environment().score.is_some() {
        return Ok((Vec::new(), calls));
    }
    let several = applications.parts.len() > 1;
    let (mut runners, mut problems) = (Vec::new(), Vec::new());
    let outlets = Outlets::default();
    let mut number = assembly.components.len();
    for part in &applications.parts {
        let components = components(part, several);
        let trees = &part.application.specification.trees;
        for (declared, plan) in trees.iter().zip(&part.application.plans) {
            let name = declared.name.clone();
            let ground = Ground {
                assembly,
                components: &components,
                rules: &applications.rules.components,
                reach: Arc::new(Reach::new(Arc::clone(supervisor), name, number)),
                outlets: &outlets,
                calls: &calls,
            };
            let orders = supervisor.orders_of(number);
            match bind(declared, Arc::clone(plan), orders, &ground) {
                Ok(runner) => runners.push(runner),
                Err(found) => problems.extend(found),
            }
            number += 1;
        }
    }
    match problems.is_empty() {
        true => Ok((runners, calls)),
        false => Err(StartError::Assembly(problems)),
    }
}

/// The components of an application by the names that its trees use.
fn components(part: &Part, several: bool) -> Vec<(String, usize)> {
    let components = part.application.specification.components.iter();
    let own = |name: &str| match name.split_once('/') {
        // With several applications in one container names begin with that of the application.
        Some((_, own)) if several => own.to_owned(),
        _ => name.to_owned(),
    };
    let names = components.map(|component| own(&component.name));
    names.zip(part.members.clone()).collect()
}
