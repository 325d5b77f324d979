//! `ports`: what a component exchanges with others.

use std::collections::HashMap;

use system_model::profile::{Located, PortProfile};
use system_model::specification::{Place, PortDirection, PortKind, PortSpecification, QueuePolicy};

use super::PORT_RULES;
use super::header::required_text;
use crate::node::Node;
use crate::suggest::quoted;
use crate::value::Value;

/// What a FIFO or LIFO without a size keeps, as the old engine's queues do.
const DEFAULT_QUEUE_SIZE: usize = 15;

/// Queues are allocated whole before the component starts.
const MAX_QUEUE_SIZE: i64 = 65_536;

const KINDS: [(&str, PortKind); 3] = [
    ("data_port", PortKind::Data),
    ("event_port", PortKind::Event),
    ("service_port", PortKind::Service),
];

/// Reads all ports of a component in document order.
pub(super) fn read(component: &Node<'_>) -> Vec<PortProfile> {
    let Some(list) = component.child("ports") else {
        return Vec::new();
    };
    let mut ports: Vec<PortProfile> = Vec::new();
    let mut places: HashMap<String, Place> = HashMap::new();
    for node in list.children_of(&KINDS.map(|(name, _)| name)) {
        let Some(port) = read_port(&node) else {
            continue;
        };
        let PortSpecification { name, place, .. } = &port.port;
        match places.get(name) {
            Some(first) if !name.is_empty() => report_duplicate(&node, name, first),
            _ => {
                places.insert(name.clone(), place.clone());
            }
        }
        ports.push(port);
    }
    list.finish();
    ports
}

fn read_port(node: &Node<'_>) -> Option<PortProfile> {
    let (_, kind) = KINDS.into_iter().find(|(name, _)| *name == node.name())?;
    let name = required_text(node, "name");
    let data_type = match kind {
        PortKind::Service => node.value_of(&["type", "data_type"]),
        PortKind::Data | PortKind::Event => node.value_of(&["data_type", "type"]),
    };
    let direction = node
        .required_value("usage")
        .and_then(|usage| direction(&usage, kind));
    let (queue, queue_size) = queue(node);
    let reference = node.value("reference").map(|value| value.located());
    node.pass_over(&["description"]);
    node.pass_over(&PORT_RULES);
    node.finish();
    Some(PortProfile {
        port: PortSpecification {
            name: name.value,
            kind,
            direction: direction.unwrap_or(PortDirection::Input),
            data_type: data_type.map_or_else(String::new, |value| value.as_str().to_owned()),
            queue,
            queue_size,
            place: name.place,
        },
        reference,
    })
}

/// The words for a direction depend on the kind of port.
pub(super) fn direction(usage: &Value<'_>, kind: PortKind) -> Option<PortDirection> {
    match kind {
        PortKind::Service => usage.choice(&[
            ("provided", PortDirection::Input),
            ("required", PortDirection::Output),
        ]),
        PortKind::Data | PortKind::Event => usage.choice(&[
            ("input", PortDirection::Input),
            ("output", PortDirection::Output),
        ]),
    }
}

fn queue(node: &Node<'_>) -> (QueuePolicy, usize) {
    let policy = node
        .value_of(&["queueing_policy", "queuing_policy", "policy"])
        .and_then(|value| queue_policy(&value))
        .unwrap_or_default();
    let size = node.value("queue_size");
    let mut parameters = node
        .children("policy_param")
        .into_iter()
        .filter_map(|node| parameter(&node));
    let size = size.or_else(|| parameters.next());
    (policy, queue_size(size, policy))
}

/// `policy_param name="size"`, the older way to give the size of a queue.
fn parameter<'a>(node: &Node<'a>) -> Option<Value<'a>> {
    let known = node
        .required_attribute("name")
        .and_then(|name| name.choice(&[("size", ())]));
    let value = node.text();
    node.finish();
    (known.is_some() && !value.is_empty()).then_some(value)
}

fn queue_policy(value: &Value<'_>) -> Option<QueuePolicy> {
    if value.as_str() == "UFIFO" {
        value.warning(
            "an unbounded queue is not offered; `UFIFO` is read as `FIFO`",
            Some("write FIFO and a queue_size that is never reached".into()),
        );
        return Some(QueuePolicy::Fifo);
    }
    value.choice(&[
        ("FIFO", QueuePolicy::Fifo),
        ("LIFO", QueuePolicy::Lifo),
        ("LAST", QueuePolicy::Last),
    ])
}

fn queue_size(value: Option<Value<'_>>, policy: QueuePolicy) -> usize {
    let default = match policy {
        QueuePolicy::Last => 1,
        QueuePolicy::Fifo | QueuePolicy::Lifo => DEFAULT_QUEUE_SIZE,
    };
    let Some(value) = value else {
        return default;
    };
    let size = value.lenient_integer();
    if (1..=MAX_QUEUE_SIZE).contains(&size) {
        return usize::try_from(size).unwrap_or(default);
    }
    value.error(
        format!("a queue of {size}"),
        Some(format!("a queue holds from 1 to {MAX_QUEUE_SIZE} elements")),
    );
    default
}

fn report_duplicate(node: &Node<'_>, name: &str, first: &Place) {
    node.error(
        format!("a second port of the name {}", quoted(name)),
        Some(format!(
            "the first one is at {first}; give each port a name of its own"
        )),
    );
}

/// A kind of port by the word used in `port_type`.
pub(super) fn kind(node: &Node<'_>, value: Option<Value<'_>>) -> Option<Located<PortKind>> {
    let Some(value) = value else {
        node.error(
            format!("<{}> has no port_type", node.name()),
            Some("port_type is data, event or service".into()),
        );
        return None;
    };
    let kind = value.choice(&[
        ("data", PortKind::Data),
        ("event", PortKind::Event),
        ("service", PortKind::Service),
    ])?;
    Some(Located {
        value: kind,
        place: value.place(),
    })
}
