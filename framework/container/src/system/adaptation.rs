//! Tasks are watched over: each application that has one gets an adaptation.

use std::sync::Arc;

use task_adaptation::Decider;

use super::applications::{Applications, Part};
use super::{StartError, System};
use crate::adaptation::{
    Adaptation, AdaptationLane, AttachedTask, Binding, Known, LocalRobot, Passage, Team,
};
use crate::assembly::{Assembly, AssemblyProblem};
use crate::component::Environment;
use crate::lane::Lane;
use crate::network::Network;
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
    let strangers = components.filter(|(component, _)| binding.part_of(*component).is_none());
    strangers.map(|(_, rule)| AssemblyProblem::Connection {
        place: rule.place.clone(),
        message: format!(
            "this component is no part of the task '{}'",
            binding.task.name
        ),
        help: "remove the <adapt>, or write an <instance> for it in the task".to_owned(),
    })
}

/// Applications that have a task, together those that are robots of the same one.
fn groups(applications: &Applications) -> Vec<Vec<(&Part, &AttachedTask)>> {
    let mut groups: Vec<Vec<(&Part, &AttachedTask)>> = Vec::new();
    for part in &applications.parts {
        let Some(attached) = &part.application.task else {
            continue;
        };
        let is_same = |group: &&mut Vec<(&Part, &AttachedTask)>| {
            let mut group = group.iter();
            group.all(|(_, other)| other.task == attached.task && other.robot != attached.robot)
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.push((part, attached)),
            None => groups.push(vec![(part, attached)]),
        }
    }
    groups
}

/// The way to other robots of a task, if its application is in the network.
fn passage(
    group: &[(&Part, &AttachedTask)],
    binding: &Binding,
    network: Option<&Network>,
) -> Result<Option<Box<dyn Passage>>, StartError> {
    let Some(network) = network else {
        return Ok(None);
    };
    let (robot, members) = network.robot();
    let in_it = group.iter().find(|(part, _)| part.members.start == members);
    let Some((_, attached)) = in_it else {
        return Ok(None);
    };
    let name = &binding.task.robots[attached.robot].name;
    if name != robot {
        return Err(StartError::Assembly(vec![AssemblyProblem::Connection {
            place: attached.place.clone(),
            message: format!("the network calls this robot '{robot}', the task '{name}'"),
            help: "give it one name: in <network name=\"…\"> and in <adapt robot=\"…\"/>"
                .to_owned(),
        }]));
    }
    let passage = network.passage(&binding.task);
    passage.map(Some).map_err(StartError::Network)
}

/// An adaptation for each task. A recording that is played changes nothing.
///
/// # Errors
/// Everything of a task that its application does not have.
pub(super) fn adapt(
    applications: &Applications,
    assembly: &Assembly,
    (environment, meter, network): (&Arc<Environment>, &Arc<Meter>, Option<&Network>),
) -> Result<Vec<Adaptation>, StartError> {
    let (mut adaptations, mut problems) = (Vec::new(), Vec::new());
    if environment.score.is_some() {
        return Ok(adaptations);
    }
    for group in groups(applications) {
        let attached = group.iter().map(|(part, attached)| {
            let known = Known {
                specification: &applications.specification,
                members: part.members.clone(),
                interfaces: &assembly.interfaces,
            };
            (*attached, known)
        });
        match Binding::new(&attached.collect::<Vec<_>>()) {
            Ok(binding) => {
                let running = binding.task.running.clone().unwrap_or_default();
                let decider = Decider::new(binding.task.clone(), running);
                let parts = group.iter().map(|(part, _)| *part);
                problems.extend(parts.flat_map(|part| strangers(part, &binding)));
                let watched = binding.parts.iter().map(|it| it.component);
                environment.adaptation_requests.watch(watched);
                let environment = Arc::clone(environment);
                let meter = Arc::clone(meter);
                let passage = passage(&group, &binding, network)?;
                let robot =
                    LocalRobot::new(binding, assembly, Arc::clone(&environment), meter, passage);
                adaptations.push(Adaptation::new(decider, Team::new(robot), environment));
            }
            Err(found) => problems.extend(found),
        }
    }
    match problems.is_empty() {
        true => Ok(adaptations),
        false => Err(StartError::Assembly(problems)),
    }
}

impl System {
    /// Starts the lane of an adaptation, where time is real.
    pub(super) fn launch_adaptation(&mut self, adaptation: Adaptation) -> Result<(), StartError> {
        let components = Arc::clone(&self.components);
        let environment = Arc::clone(&self.environment);
        let work = AdaptationLane::new(adaptation, components, environment);
        let lane = Lane::new("adaptation", Box::new(work));
        self.crew.start(&lane, || {})?;
        // Components of its own it has none: those that it enters belong to their executors.
        self.lanes.push((lane, Vec::new()));
        Ok(())
    }
}
