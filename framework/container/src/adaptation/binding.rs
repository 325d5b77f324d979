//! A task meets the application that it is to run in: every name finds its component, every link its
//! ports, every evaluator its field.

use fault_manager::detection::NumberReader;
use system_model::profile::Located;
use system_model::specification::{PortKind, PortReference, QueuePolicy};
use system_model::task::{
    ComponentIndex, ContainerFigure, Evaluator, Placement, QualityAttribute, ResourceIndex,
    RobotIndex, TaskInstance, TaskSpecification,
};

use super::AttachedTask;
use super::known::{Known, misfit};
use super::linking::routes;
use super::wiring::{PortKey, Route};
use crate::assembly::AssemblyProblem;

/// A task as it is bound to this system.
pub struct Binding {
    /// The task.
    pub task: TaskSpecification,
    /// The robot of the task that this system is.
    pub robot: RobotIndex,
    /// By component of the task; none for one that this robot does not have.
    pub parts: Vec<Option<Part>>,
    /// Links between components of this robot.
    pub routes: Vec<Route>,
    /// What ports tell of the robot's resources.
    pub sensors: Vec<BoundSensor>,
    /// What inputs of links keep.
    queues: Vec<(PortKey, (QueuePolicy, usize))>,
}

/// A component of the task on this robot.
pub struct Part {
    /// Index among all components of the system.
    pub component: usize,
    /// What tells its functional error.
    pub evaluators: Vec<BoundEvaluator>,
    /// What it estimates itself, and for how many cycles it is run to be estimated.
    pub own_estimate: Option<(PortKey, NumberReader)>,
    /// For how many cycles it is run to be estimated.
    pub cycles: u32,
    /// Resources of which the use is measured.
    pub gauges: Vec<(ResourceIndex, ContainerFigure)>,
    /// Where its inputs that are no links of the task get their data from.
    pub sources: Vec<(PortKey, PortKey)>,
}

/// An evaluator with its field.
pub struct BoundEvaluator {
    /// The output.
    pub key: PortKey,
    /// The field; none for an age.
    pub reader: Option<NumberReader>,
    /// What it says of it.
    pub rule: Evaluator,
    /// Where the values are kept that a deviation is made of.
    pub window: Option<usize>,
}

/// A port that tells what the robot has of a resource.
pub struct BoundSensor {
    /// Which resource.
    pub resource: ResourceIndex,
    /// The output.
    pub key: PortKey,
    /// The field.
    pub reader: NumberReader,
    /// What the field is multiplied with.
    pub scale: f64,
}

impl Binding {
    /// Binds a task.
    ///
    /// # Errors
    /// Everything of it that the application does not have.
    pub fn new(attached: &AttachedTask, known: &Known<'_>) -> Result<Self, Vec<AssemblyProblem>> {
        let AttachedTask { task, robot, place } = attached;
        let (task, robot) = (task.clone(), *robot);
        let mut problems = Vec::new();
        if task.running.is_none() {
            problems.push(misfit(
                place,
                format!("the task '{}' does not say what runs", task.name),
                "write <running> into its file: what runs when the application starts",
            ));
        }
        let parts = parts(&task, robot, known, &mut problems);
        let routes = routes(&task, &parts, known, &mut problems);
        let sensors = task.robots[robot].sensors.iter().filter_map(|sensor| {
            let Located { value, place } = sensor;
            let component = known.component(&value.subcomponent, place, &mut problems)?;
            let field = value.field.as_deref();
            let found = known.number(component, &value.port, field, place, &mut problems);
            let (key, reader) = found?;
            Some(BoundSensor {
                resource: value.resource,
                key,
                reader,
                scale: value.scale,
            })
        });
        let sensors = sensors.collect();
        let inputs = routes.iter().flat_map(|route| {
            let stages = route.through.iter().map(|stage| &stage.input);
            stages.chain([&route.to])
        });
        let queues = inputs.map(|input| (input.clone(), known.queue(input)));
        let queues = queues.collect();
        match problems.is_empty() {
            true => Ok(Self {
                task,
                robot,
                parts,
                routes,
                sensors,
                queues,
            }),
            false => Err(problems),
        }
    }

    /// The part of this robot that a placement is; none on another robot.
    pub fn part(&self, placement: Placement) -> Option<&Part> {
        if placement.robot != self.robot {
            return None;
        }
        self.parts.get(placement.component)?.as_ref()
    }

    /// Which component of the task a component of the system is.
    pub fn task_component(&self, component: usize) -> Option<ComponentIndex> {
        let is_it = |part: &Option<Part>| part.as_ref().is_some_and(|it| it.component == component);
        self.parts.iter().position(is_it)
    }

    /// What an input of a link keeps.
    pub fn queue(&self, input: &PortKey) -> (QueuePolicy, usize) {
        let found = self.queues.iter().find(|(key, _)| key == input);
        found.map_or((QueuePolicy::Last, 1), |(_, queue)| *queue)
    }

    /// Whether the age of data counts that components in use write: it grows though nothing comes.
    pub fn watches_age(&self, placements: &[Placement]) -> bool {
        let parts = placements.iter().filter_map(|it| self.part(*it));
        let mut evaluators = parts.flat_map(|part| &part.evaluators);
        evaluators.any(|it| it.rule.attribute == QualityAttribute::Age)
    }

    /// Every output whose data are asked for: by evaluators and sensors, at the beginning of
    /// connections that may be made, and where inputs of those that are estimated come from.
    pub fn outlets(&self) -> Vec<PortKey> {
        let parts = || self.parts.iter().flatten();
        let evaluators = parts().flat_map(|part| part.evaluators.iter().map(|it| &it.key));
        let sensors = self.sensors.iter().map(|sensor| &sensor.key);
        let links = self.routes.iter().flat_map(|route| {
            let stages = route.through.iter().map(|stage| &stage.output);
            stages.chain([&route.from])
        });
        let inputs = parts().flat_map(|part| part.sources.iter().map(|(source, _)| source));
        let all = evaluators.chain(sensors).chain(links).chain(inputs);
        let mut outlets: Vec<PortKey> = all.cloned().collect();
        outlets.sort();
        outlets.dedup();
        outlets
    }
}

fn parts(
    task: &TaskSpecification,
    robot: RobotIndex,
    known: &Known<'_>,
    problems: &mut Vec<AssemblyProblem>,
) -> Vec<Option<Part>> {
    let mut parts: Vec<Option<Part>> = task.components.iter().map(|_| None).collect();
    for instance in &task.robots[robot].instances {
        parts[instance.component] = part(task, instance, known, problems);
    }
    parts
}

fn part(
    task: &TaskSpecification,
    instance: &TaskInstance,
    known: &Known<'_>,
    problems: &mut Vec<AssemblyProblem>,
) -> Option<Part> {
    let attachment = &instance.attachment;
    let name = &task.components[instance.component].name;
    let name = attachment.subcomponent.as_ref().unwrap_or(name);
    let component = known.component(name, &attachment.place, problems)?;
    let evaluators = attachment.evaluators.iter();
    let evaluators = evaluators.filter_map(|it| evaluator(it, component, known, problems));
    let evaluators = evaluators.collect();
    let estimator = attachment.estimator.as_ref();
    let own_estimate = estimator.and_then(|estimator| {
        let (port, field) = estimator.value.own.as_ref()?;
        let place = &estimator.place;
        known.number(component, port, field.as_deref(), place, problems)
    });
    let inputs = known.specification.connections.iter();
    let inputs = inputs.filter(|it| it.kind == PortKind::Data && it.target.component == component);
    Some(Part {
        component,
        evaluators,
        own_estimate,
        cycles: estimator.map_or(1, |estimator| estimator.value.cycles),
        gauges: attachment.gauges.clone(),
        sources: inputs
            .map(|it| (key(&it.source), key(&it.target)))
            .collect(),
    })
}

fn evaluator(
    evaluator: &Located<Evaluator>,
    component: usize,
    known: &Known<'_>,
    problems: &mut Vec<AssemblyProblem>,
) -> Option<BoundEvaluator> {
    let Located { value: rule, place } = evaluator;
    let (key, reader) = match rule.attribute {
        QualityAttribute::Age => (
            known.output(component, &rule.port, place, problems)?.0,
            None,
        ),
        _ => {
            let field = rule.field.as_deref();
            let (key, reader) = known.number(component, &rule.port, field, place, problems)?;
            (key, Some(reader))
        }
    };
    Some(BoundEvaluator {
        key,
        reader,
        rule: rule.clone(),
        window: None,
    })
}

fn key(port: &PortReference) -> PortKey {
    PortKey {
        component: port.component,
        port: port.port.clone(),
    }
}
