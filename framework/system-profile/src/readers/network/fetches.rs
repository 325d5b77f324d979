//! `fetch`: components that other robots send if this one lacks them.

use system_model::network::FETCH_LIMIT;
use system_model::profile::{FetchProfile, Located};

use super::name;
use crate::node::Node;
use crate::readers::rules::measure::positive_duration;
use crate::suggest::quoted;

/// A start asks for them one after the other.
const FETCHES_MAXIMUM: usize = 64;

/// Reads all children `fetch` of the network of this robot.
pub(super) fn read(network: &Node<'_>, own: Option<&Located<String>>) -> Vec<FetchProfile> {
    let nodes = network.children("fetch");
    if let Some(node) = nodes.get(FETCHES_MAXIMUM) {
        node.error(
            format!("{} components are fetched", nodes.len()),
            Some(format!("write at most {FETCHES_MAXIMUM}")),
        );
    }
    let mut fetches: Vec<FetchProfile> = Vec::new();
    for node in nodes.iter().take(FETCHES_MAXIMUM) {
        let Some(fetch) = fetch(node) else {
            continue;
        };
        let mut earlier = fetches.iter().map(|it| &it.component);
        if let Some(first) = earlier.find(|it| it.value == fetch.component.value) {
            node.error(
                format!("{} is fetched twice", quoted(&first.value)),
                Some(format!("the first time is at {}; remove one", first.place)),
            );
        }
        if own.is_some_and(|own| own.value == fetch.robot.value) {
            node.error(
                format!("{} is this robot", quoted(&fetch.robot.value)),
                Some("name the robot that has the component".into()),
            );
        }
        fetches.push(fetch);
    }
    fetches
}

fn fetch(node: &Node<'_>) -> Option<FetchProfile> {
    let component = node.required_attribute("component");
    let component = component.and_then(|value| name(&value, "component"));
    let robot = node.required_attribute("from");
    let robot = robot.and_then(|value| name(&value, "robot"));
    let key = node.required_attribute("key");
    let limit = node.attribute("within");
    let limit = limit.map_or(Some(FETCH_LIMIT), |value| positive_duration(&value));
    node.finish();
    Some(FetchProfile {
        component: component?,
        robot: robot?,
        key: key?.located(),
        limit: limit?,
    })
}
