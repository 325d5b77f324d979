//! The task's state machine.

use system_model::task::{StateMachine, SubTask, TaskState, Transition};

use super::names::{Names, bounded, declared};
use crate::node::Node;
use crate::suggest::quoted;

const MAX_STATES: usize = 200;
const MAX_TRANSITIONS: usize = 1000;

pub(super) fn read(root: &Node<'_>, sub_tasks: &[SubTask]) -> Option<StateMachine> {
    let node = root.required_child("state_machine")?;
    let sub_task_names = Names::of("sub_task", sub_tasks.iter().map(|it| &it.name));
    let nodes = bounded(node.children("state"), MAX_STATES);
    let mut known = Vec::new();
    let states = nodes
        .iter()
        .map(|node| state(node, &sub_task_names, &mut known));
    let mut states: Vec<TaskState> = states.collect();
    if states.is_empty() {
        node.error(
            "a state machine needs a state",
            Some("write <state name=\"…\"><run sub_task=\"…\"/></state>".into()),
        );
    }
    let names = Names::of("state", states.iter().map(|it| &it.name));
    let initial = names.required(&node, "initial");
    let nodes = bounded(node.children("transition"), MAX_TRANSITIONS);
    let mut transitions = Vec::new();
    for node in &nodes {
        transition(node, &names, &mut transitions);
    }
    node.finish();
    check_use(&node, sub_tasks, &states);
    let initial = initial?;
    check_reach(&nodes, &node, initial, &states, &transitions);
    // The first one is that in which the task begins.
    states.swap(0, initial);
    let moved = |state: usize| match state {
        0 => initial,
        state if state == initial => 0,
        state => state,
    };
    for transition in &mut transitions {
        (transition.from, transition.to) = (moved(transition.from), moved(transition.to));
    }
    Some(StateMachine {
        states,
        transitions,
    })
}

fn state(
    node: &Node<'_>,
    sub_tasks: &Names,
    known: &mut Vec<(String, system_model::specification::Place)>,
) -> TaskState {
    let name = declared(node, known);
    let runs = bounded(node.children("run"), MAX_STATES);
    let sub_tasks = runs.iter().filter_map(|run| {
        let sub_task = sub_tasks.required(run, "sub_task");
        run.finish();
        sub_task
    });
    let sub_tasks = sub_tasks.collect();
    node.finish();
    TaskState {
        name: name.unwrap_or_default(),
        sub_tasks,
    }
}

fn transition(node: &Node<'_>, names: &Names, transitions: &mut Vec<Transition>) {
    let event = node.required_attribute("event");
    let (from, to) = (names.required(node, "from"), names.required(node, "to"));
    node.finish();
    let (Some(event), Some(from), Some(to)) = (event, from, to) else {
        return;
    };
    let mut others = transitions.iter();
    if others.any(|other| other.from == from && other.event == event.as_str()) {
        event.error(
            format!("`{}` leads from there already", quoted(event.as_str())),
            Some("one event leads to one state; remove or rename one of them".into()),
        );
        return;
    }
    transitions.push(Transition {
        from,
        to,
        event: event.as_str().to_owned(),
    });
}

fn check_use(node: &Node<'_>, sub_tasks: &[SubTask], states: &[TaskState]) {
    for (index, sub_task) in sub_tasks.iter().enumerate() {
        if !states.iter().any(|state| state.sub_tasks.contains(&index)) {
            node.warning(
                format!("no state runs the sub-task `{}`", quoted(&sub_task.name)),
                Some(format!(
                    "write <run sub_task=\"{}\"/> in a state, or remove the sub-task",
                    quoted(&sub_task.name)
                )),
            );
        }
    }
}

fn check_reach(
    transitions: &[Node<'_>],
    node: &Node<'_>,
    initial: usize,
    states: &[TaskState],
    read: &[Transition],
) {
    if transitions.len() != read.len() {
        return;
    }
    let mut reached = vec![initial];
    let mut next = 0;
    while let Some(state) = reached.get(next).copied() {
        next += 1;
        for transition in read.iter().filter(|it| it.from == state) {
            if !reached.contains(&transition.to) {
                reached.push(transition.to);
            }
        }
    }
    for (index, state) in states.iter().enumerate() {
        if !reached.contains(&index) {
            node.warning(
                format!("no transition leads to the state `{}`", quoted(&state.name)),
                Some("write a <transition> to it, or remove it".into()),
            );
        }
    }
}
