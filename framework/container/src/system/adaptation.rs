//! Tasks are watched over: each application that has one gets an adaptation.

use std::sync::Arc;

use system_model::task::Placement;
use task_adaptation::Decider;

use super::applications::{Applications, Part};
use crate::adaptation::{Adaptation, Binding, Known, LocalRobot};
use crate::assembly::{Assembly, AssemblyProblem};
use crate::component::Environment;
use crate::status::Meter;

/// Components that have a rung for a task in which they take no part.
fn strangers<'part>(
    part: &'part Part,
    binding: &'part Binding,
) -> impl Iterator<Item = AssemblyProblem> + 'part {
    let components = part.members.clone().filter_map(|component| {
        let rule = part.rules.components.get(component)?.adapt.as_ref()?;
        Some((component, rule))
    });
    let strangers =
        components.filter(|(component, _)| binding.task_component(*component).is_none());
    strangers.map(|(_, rule)| AssemblyProblem::Connection {
        place: rule.place.clone(),
        message: format!(
            "this component is no part of the task '{}'",
            binding.task.name
        ),
        help: "remove the <adapt>, or write an <instance> for it in the task".to_owned(),
    })
}

/// An adaptation for each task. A recording that is played changes nothing.
///
/// # Errors
/// Everything of a task that its application does not have.
pub(super) fn adapt(
    applications: &Applications,
    assembly: &Assembly,
    environment: &Arc<Environment>,
    meter: &Arc<Meter>,
) -> Result<Vec<Adaptation>, Vec<AssemblyProblem>> {
    let (mut adaptations, mut problems) = (Vec::new(), Vec::new());
    if environment.score.is_some() {
        return Ok(adaptations);
    }
    for part in &applications.parts {
        let Some(attached) = &part.application.task else {
            continue;
        };
        let known = Known {
            specification: &applications.specification,
            members: part.members.clone(),
            interfaces: &assembly.interfaces,
        };
        match Binding::new(attached, &known) {
            Ok(binding) => {
                let running = attached.task.running.clone();
                let running: Vec<Placement> = running.unwrap_or_default();
                let decider = Decider::new(attached.task.clone(), running);
                problems.extend(strangers(part, &binding));
                let members = part.members.clone();
                let watched = members.filter(|it| binding.task_component(*it).is_some());
                environment.adaptation_requests.watch(watched);
                let environment = Arc::clone(environment);
                let meter = Arc::clone(meter);
                let robot = LocalRobot::new(binding, assembly, Arc::clone(&environment), meter);
                adaptations.push(Adaptation::new(decider, Box::new(robot), environment));
            }
            Err(found) => problems.extend(found),
        }
    }
    match problems.is_empty() {
        true => Ok(adaptations),
        false => Err(problems),
    }
}
