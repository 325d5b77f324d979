//! What the task is made of: sub-tasks with their components, links, exclusions.

use std::ops::RangeInclusive;

use system_model::task::{
    ComponentClass, ComponentIndex, LinkPorts, SubTask, TaskComponent, TaskLink,
};

use super::names::{Names, bounded, declared};
use crate::node::Node;
use crate::readers::world::quantity::within;
use crate::suggest::quoted;

/// The paper's task has eight components; no chain of a robot is so long.
const MAX_COMPONENTS: usize = 200;
/// Any of so many may be used or not: 4096 sets.
const MAX_OPTIONAL: usize = 12;
const MAX_LINKS: usize = 1000;
const MAX_EXCLUSIONS: usize = 100;

/// Errors, thresholds and amounts, in whatever unit: sums of them stay finite.
pub(super) const AMOUNT: RangeInclusive<f64> = 0.0..=1e12;

/// Sub-tasks and all their components.
pub(super) struct Structure {
    pub(super) sub_tasks: Vec<SubTask>,
    pub(super) components: Vec<TaskComponent>,
}

pub(super) fn read(root: &Node<'_>) -> Structure {
    let mut structure = Structure {
        sub_tasks: Vec::new(),
        components: Vec::new(),
    };
    let Some(list) = root.required_child("sub_tasks") else {
        return structure;
    };
    let (mut sub_task_names, mut component_names) = (Vec::new(), Vec::new());
    let nodes = list.children("sub_task");
    if nodes.is_empty() {
        list.error(
            "<sub_tasks> is empty",
            Some("write <sub_task name=\"…\">…".into()),
        );
    }
    for node in bounded(nodes, MAX_COMPONENTS) {
        let name = declared(&node, &mut sub_task_names);
        let mut sub_task = SubTask {
            name: name.unwrap_or_default(),
            components: Vec::new(),
        };
        let components = node.children("component");
        if components.is_empty() {
            node.error(
                "a sub-task needs components",
                Some("write <component name=\"…\" class=\"sensor\"/> in it".into()),
            );
        }
        for component in bounded(components, MAX_COMPONENTS - structure.components.len()) {
            let name = declared(&component, &mut component_names);
            sub_task.components.push(structure.components.len());
            structure
                .components
                .push(read_component(&component, name.unwrap_or_default()));
        }
        node.finish();
        structure.sub_tasks.push(sub_task);
    }
    list.finish();
    check_kinds(&list, &structure.components);
    structure
}

fn read_component(node: &Node<'_>, name: String) -> TaskComponent {
    let class = node.required_attribute("class").and_then(|value| {
        value.choice(&[
            ("sensor", ComponentClass::Sensor),
            ("actuator", ComponentClass::Actuator),
            ("computation", ComponentClass::Computation),
        ])
    });
    let essential = node
        .attribute("essential")
        .and_then(|value| value.boolean());
    let threshold = node.attribute("threshold");
    let threshold = threshold.and_then(|value| within(&value, &AMOUNT));
    node.finish();
    TaskComponent {
        name,
        class: class.unwrap_or(ComponentClass::Computation),
        is_essential: essential.unwrap_or(true),
        threshold: threshold.unwrap_or(1.0),
    }
}

fn check_kinds(list: &Node<'_>, components: &[TaskComponent]) {
    let optional = components.iter().filter(|it| !it.is_essential).count();
    if optional > MAX_OPTIONAL {
        list.error(
            format!("{optional} components are not essential"),
            Some(format!(
                "any set of them may be used; keep at most {MAX_OPTIONAL}"
            )),
        );
    }
    if optional == components.len() && optional > 0 {
        list.error(
            "no component is essential",
            Some("remove essential=\"false\" from those without which the task is not done".into()),
        );
    }
}

/// Who gives output to whom.
pub(super) fn links(root: &Node<'_>, components: &[TaskComponent], names: &Names) -> Vec<TaskLink> {
    let Some(list) = root.child("links") else {
        return Vec::new();
    };
    let nodes = bounded(list.children("link"), MAX_LINKS);
    let links = nodes
        .iter()
        .filter_map(|node| link(node, components, names));
    let links = links.collect();
    list.finish();
    links
}

fn link(node: &Node<'_>, components: &[TaskComponent], names: &Names) -> Option<TaskLink> {
    let end = |name| {
        let component = names.required(node, name)?;
        of_kind(node, components, component, true)
    };
    let (from, to) = (end("from"), end("to"));
    let nodes = bounded(node.children("through"), MAX_OPTIONAL);
    let port = |node: &Node<'_>, name| {
        let value = node.attribute(name)?;
        Some(value.as_str().to_owned())
    };
    let through = nodes.iter().filter_map(|node| {
        let component = names.required(node, "component");
        let ports = (port(node, "input"), port(node, "output"));
        node.finish();
        Some((of_kind(node, components, component?, false)?, ports))
    });
    let (through, stages): (Vec<ComponentIndex>, Vec<_>) = through.unzip();
    let ports = LinkPorts {
        output: port(node, "output"),
        input: port(node, "input"),
        through: stages,
        place: node.place(),
    };
    node.finish();
    let (from, to) = (from?, to?);
    if from == to {
        node.error(
            format!("`{}` is linked with itself", quoted(&components[from].name)),
            Some("remove the link, or name another component".into()),
        );
        return None;
    }
    Some(TaskLink {
        from,
        to,
        through,
        ports,
    })
}

/// A component that is essential, or is not, as its place asks for.
fn of_kind(
    node: &Node<'_>,
    components: &[TaskComponent],
    component: ComponentIndex,
    essential: bool,
) -> Option<ComponentIndex> {
    let TaskComponent {
        name, is_essential, ..
    } = &components[component];
    if *is_essential == essential {
        return Some(component);
    }
    let (what, help) = match essential {
        true => (
            "is not essential, and a link needs both its ends",
            "link essential components and write <through> in the link for the others",
        ),
        false => (
            "is essential, and here only others stand",
            "write essential=\"false\" where it is declared, or remove it here",
        ),
    };
    node.error(format!("`{}` {what}", quoted(name)), Some(help.into()));
    None
}

/// Of which components at most one may be used.
pub(super) fn exclusions(
    root: &Node<'_>,
    components: &[TaskComponent],
    names: &Names,
) -> Vec<Vec<ComponentIndex>> {
    let Some(list) = root.child("exclusions") else {
        return Vec::new();
    };
    let nodes = bounded(list.children("exclusion"), MAX_EXCLUSIONS);
    let exclusions = nodes.iter().map(|node| {
        let members = node.children("use");
        if members.len() < 2 {
            node.error(
                "an exclusion needs two components",
                Some("write <use component=\"…\"/> for each of them".into()),
            );
        }
        let members = members.iter().filter_map(|member| {
            let component = names.required(member, "component");
            member.finish();
            of_kind(member, components, component?, false)
        });
        let members = members.collect();
        node.finish();
        members
    });
    let exclusions = exclusions.collect();
    list.finish();
    exclusions
}
