//! The robots: what they have, which components can run on them, what runs.

use system_model::task::{
    Condition, GivenEstimate, Placement, TaskInstance, TaskRobot, TaskSpecification,
};

use super::attachment;
use super::names::{Names, bounded, declared};
use super::structure::AMOUNT;
use crate::node::Node;
use crate::readers::world::quantity::attribute;
use crate::suggest::quoted;

const MAX_ROBOTS: usize = 100;
/// As many as there may be components.
const MAX_INSTANCES: usize = 200;
/// One for each way in which other components can help or harm.
const MAX_ESTIMATES: usize = 100;

/// What a robot's elements may refer to.
pub(super) struct Known<'a> {
    pub(super) resources: &'a Names,
    pub(super) components: &'a Names,
}

pub(super) fn read(root: &Node<'_>, known: &Known<'_>) -> Vec<TaskRobot> {
    let Some(list) = root.required_child("robots") else {
        return Vec::new();
    };
    let nodes = bounded(list.children("robot"), MAX_ROBOTS);
    if nodes.is_empty() {
        list.error(
            "<robots> is empty",
            Some("write <robot name=\"…\">…".into()),
        );
    }
    let mut taken = Vec::new();
    let names = nodes
        .iter()
        .map(|node| declared(node, &mut taken).unwrap_or_default());
    let names: Vec<String> = names.collect();
    let robot_names = Names::of("robot", &names);
    let robots = nodes.iter().zip(&names).map(|(node, name)| {
        let robot = TaskRobot {
            name: name.clone(),
            available: amounts(node, "has", known.resources),
            sensors: attachment::sensors(node, known.resources),
            instances: instances(node, known, &robot_names),
        };
        node.finish();
        robot
    });
    let robots = robots.collect();
    list.finish();
    robots
}

/// Amounts of resources by the elements of a name; 0 of those that are not named.
fn amounts(node: &Node<'_>, element: &'static str, resources: &Names) -> Vec<f64> {
    let mut amounts = vec![None; resources.count()];
    for node in bounded(node.children(element), resources.count().max(1)) {
        let resource = resources.required(&node, "resource");
        let amount = attribute(&node, "amount", AMOUNT);
        node.finish();
        let Some(slot) = resource.and_then(|resource| amounts.get_mut(resource)) else {
            continue;
        };
        if slot.replace(amount.unwrap_or(0.0)).is_some() {
            node.error(
                "this resource stands here again",
                Some("add the amounts up and write them once".into()),
            );
        }
    }
    amounts
        .into_iter()
        .map(|amount| amount.unwrap_or(0.0))
        .collect()
}

fn instances(robot: &Node<'_>, known: &Known<'_>, robots: &Names) -> Vec<TaskInstance> {
    let mut instances: Vec<TaskInstance> = Vec::new();
    for node in bounded(robot.children("instance"), MAX_INSTANCES) {
        let component = known.components.required(&node, "component");
        let demand = amounts(&node, "needs", known.resources);
        let estimates = estimates(&node, known, robots);
        let attachment = attachment::read(&node, known.resources);
        node.finish();
        let Some(component) = component else {
            continue;
        };
        if instances.iter().any(|other| other.component == component) {
            node.error(
                "this robot has the component already",
                Some("one instance of each is enough; remove one of them".into()),
            );
            continue;
        }
        instances.push(TaskInstance {
            component,
            demand,
            estimates,
            attachment,
        });
    }
    instances
}

fn estimates(instance: &Node<'_>, known: &Known<'_>, robots: &Names) -> Vec<GivenEstimate> {
    let mut estimates: Vec<GivenEstimate> = Vec::new();
    for node in bounded(instance.children("estimate"), MAX_ESTIMATES) {
        if estimates.last().is_some_and(|last| last.with.is_empty()) {
            node.warning(
                "this estimate is never used: the one before has no conditions",
                Some("put that one last".into()),
            );
        }
        let functional = attribute(&node, "functional", AMOUNT);
        let conditions = bounded(node.children("with"), MAX_INSTANCES);
        let with = conditions.iter().filter_map(|node| {
            let component = known.components.required(node, "component");
            let robot = node.attribute("robot").map(|value| robots.find(&value));
            node.finish();
            Some(Condition {
                component: component?,
                robot: match robot {
                    Some(robot) => Some(robot?),
                    None => None,
                },
            })
        });
        let with = with.collect();
        node.finish();
        estimates.push(GivenEstimate {
            functional: functional.unwrap_or(0.0),
            with,
        });
    }
    estimates
}

/// What runs when nothing has been decided yet.
pub(super) fn running(
    list: &Node<'_>,
    task: &TaskSpecification,
    components: &Names,
) -> Vec<Placement> {
    let robots = Names::of("robot", task.robots.iter().map(|it| &it.name));
    let mut running: Vec<Placement> = Vec::new();
    for node in bounded(list.children("use"), MAX_INSTANCES) {
        let component = components.required(&node, "component");
        let robot = robots.required(&node, "robot");
        node.finish();
        let (Some(component), Some(robot)) = (component, robot) else {
            continue;
        };
        let placement = Placement { component, robot };
        if task.instance(placement).is_none() {
            node.error(
                format!("there is no {}", quoted(&task.placement_name(placement))),
                Some("name a robot that has an <instance> of the component".into()),
            );
        }
        let excluded = |other: &Placement| {
            let mut exclusions = task.exclusions.iter();
            other.component == component
                || exclusions.any(|it| it.contains(&component) && it.contains(&other.component))
        };
        if let Some(other) = running.iter().find(|other| excluded(other)) {
            node.error(
                format!(
                    "it cannot be used together with {}",
                    quoted(&task.placement_name(*other))
                ),
                Some("remove one of them".into()),
            );
        }
        running.push(placement);
    }
    list.finish();
    for (index, component) in task.components.iter().enumerate() {
        if component.is_essential && !running.iter().any(|it| it.component == index) {
            list.error(
                format!(
                    "`{}` is essential and does not run",
                    quoted(&component.name)
                ),
                Some(format!(
                    "write <use component=\"{}\" robot=\"…\"/>",
                    component.name
                )),
            );
        }
    }
    running.sort_unstable();
    running
}

/// What makes the task impossible, or a component useless, is allowed: a robot may come later.
pub(super) fn warn_of_missing(root: &Node<'_>, task: &TaskSpecification) {
    for (index, component) in task.components.iter().enumerate() {
        if task.robots_with(index).is_empty() && !component.name.is_empty() {
            let consequence = match component.is_essential {
                true => "so the task cannot be done",
                false => "so it is never used",
            };
            root.warning(
                format!("no robot has `{}`, {consequence}", quoted(&component.name)),
                Some("write an <instance> of it for a robot".into()),
            );
        }
    }
}
