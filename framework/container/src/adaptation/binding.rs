//! A task meets the application that it is to run in: every name finds its component, every link its
//! ports, every evaluator its field.

use fault_manager::detection::NumberReader;
use system_model::profile::Located;
use system_model::specification::{PortKind, PortReference, QueuePolicy};
use system_model::task::{
    ContainerFigure, Evaluator, Placement, QualityAttribute, ResourceIndex, RobotIndex,
    TaskInstance, TaskSpecification,
};

use super::AttachedTask;
use super::known::{Known, misfit};
use super::linking::{LinkEnd, link_ends};
use super::wiring::{Hop, PortKey};
use crate::assembly::AssemblyProblem;

/// A task as it is bound to this system.
pub struct Binding {
    /// The task.
    pub task: TaskSpecification,
    /// The robots of the task whose applications this system runs.
    pub robots: Vec<RobotIndex>,
    /// What these robots have of it.
    pub parts: Vec<Part>,
    /// Where they meet its links.
    pub ends: Vec<LinkEnd>,
    /// What ports tell of the robots' resources.
    pub sensors: Vec<BoundSensor>,
    /// What inputs of links keep.
    queues: Vec<(PortKey, (QueuePolicy, usize))>,
}

/// A component of the task on a robot of this system.
pub struct Part {
    /// Which component of the task, on which robot.
    pub placement: Placement,
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
    /// Which robot of the task.
    pub robot: RobotIndex,
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
    /// Binds a task to the applications of one or more of its robots; it is the same for all.
    ///
    /// # Errors
    /// Everything of it that the applications do not have.
    pub fn new(attached: &[(&AttachedTask, Known<'_>)]) -> Result<Self, Vec<AssemblyProblem>> {
        let Some((first, _)) = attached.first() else {
            return Err(Vec::new());
        };
        let mut problems = Vec::new();
        let mut binding = Self {
            task: first.task.clone(),
            robots: attached.iter().map(|(it, _)| it.robot).collect(),
            parts: Vec::new(),
            ends: Vec::new(),
            sensors: Vec::new(),
            queues: Vec::new(),
        };
        if first.task.running.is_none() {
            problems.push(misfit(
                &first.place,
                format!("the task '{}' does not say what runs", first.task.name),
                "write <running> into its file: what runs when the application starts",
            ));
        }
        for (task, known) in attached {
            binding.add(task.robot, known, &mut problems);
        }
        match problems.is_empty() {
            true => Ok(binding),
            false => Err(problems),
        }
    }

    fn add(&mut self, robot: RobotIndex, known: &Known<'_>, problems: &mut Vec<AssemblyProblem>) {
        let Self { task, parts, .. } = self;
        for instance in &task.robots[robot].instances {
            parts.extend(part(task, robot, instance, known, problems));
        }
        let ends = link_ends(&task.links, robot, parts, known, problems);
        let inputs = ends.iter().filter_map(|end| end.input.as_ref());
        let queues = inputs.map(|input| (input.clone(), known.queue(input)));
        self.queues.extend(queues);
        self.ends.extend(ends);
        let sensors = task.robots[robot].sensors.iter().filter_map(|sensor| {
            let Located { value, place } = sensor;
            let component = known.component(&value.subcomponent, place, problems)?;
            let field = value.field.as_deref();
            let found = known.number(component, &value.port, field, place, problems);
            let (key, reader) = found?;
            Some(BoundSensor {
                robot,
                resource: value.resource,
                key,
                reader,
                scale: value.scale,
            })
        });
        self.sensors.extend(sensors);
    }

    /// The part of this system that a placement is; none on a robot elsewhere.
    pub fn part(&self, placement: Placement) -> Option<&Part> {
        self.parts.iter().find(|it| it.placement == placement)
    }

    /// The part of the task that a component of the system is.
    pub fn part_of(&self, component: usize) -> Option<&Part> {
        self.parts.iter().find(|it| it.component == component)
    }

    /// The output at the beginning of a connection, if it is of this system.
    pub fn output(&self, hop: &Hop) -> Option<(&PortKey, &LinkEnd)> {
        let end = self.end(hop.link, hop.from)?;
        Some((end.output.as_ref()?, end))
    }

    /// The input at the end of a connection, if it is of this system.
    pub fn input(&self, hop: &Hop) -> Option<(&PortKey, &LinkEnd)> {
        let end = self.end(hop.link, hop.to)?;
        Some((end.input.as_ref()?, end))
    }

    fn end(&self, link: usize, placement: Placement) -> Option<&LinkEnd> {
        let mut ends = self.ends.iter();
        ends.find(|it| it.link == link && it.placement == placement)
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
        let parts = || self.parts.iter();
        let evaluators = parts().flat_map(|part| part.evaluators.iter().map(|it| &it.key));
        let sensors = self.sensors.iter().map(|sensor| &sensor.key);
        let links = self.ends.iter().filter_map(|end| end.output.as_ref());
        let inputs = parts().flat_map(|part| part.sources.iter().map(|(source, _)| source));
        let all = evaluators.chain(sensors).chain(links).chain(inputs);
        let mut outlets: Vec<PortKey> = all.cloned().collect();
        outlets.sort();
        outlets.dedup();
        outlets
    }
}

fn part(
    task: &TaskSpecification,
    robot: RobotIndex,
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
        placement: Placement {
            component: instance.component,
            robot,
        },
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
