//! `system_config`: the engine's own settings.

use system_model::profile::{
    Channel, Deployment, LoadPolicy, Logger, NodeAddress, Setting, SystemProfile,
};

use super::header::{attribute, required_attribute};
use crate::node::Node;
use crate::value::Value;

/// Reads a system file.
pub(super) fn read(root: &Node<'_>) -> SystemProfile {
    root.pass_over(&[
        "name",
        "description",
        "copyright",
        "applications",
        "dependency",
    ]);
    let mut profile = SystemProfile {
        file: root.place().file,
        ..SystemProfile::default()
    };
    if let Some(node) = root.child("system_props") {
        profile.properties = finished_settings(&node);
    }
    if let Some(node) = root.child("logger_factory") {
        profile.loggers = node.children("logger").iter().map(logger).collect();
        node.finish();
    }
    if let Some(node) = root.child("package_deployer") {
        profile.deployment = deployment(&node);
    }
    if let Some(node) = root.child("component_manager") {
        component_manager(&node, &mut profile);
    }
    if let Some(node) = root.child("io_manager") {
        profile.channels = node.children("io").iter().map(channel).collect();
        node.pass_over(&["event_processor"]);
        node.finish();
    }
    if let Some(node) = root.child("mwadaptor_manager") {
        profile.middleware = finished_settings(&node);
    }
    profile
}

fn settings(node: &Node<'_>) -> Vec<Setting> {
    let settings = node.children("prop").into_iter().map(|property| {
        let name = required_attribute(&property, "name").value;
        let value = property.text().as_str().to_owned();
        property.finish();
        (name, value)
    });
    settings.collect()
}

fn finished_settings(node: &Node<'_>) -> Vec<Setting> {
    let settings = settings(node);
    node.finish();
    settings
}

fn enabled(node: &Node<'_>) -> bool {
    let value = node.attribute("enable").and_then(|value| value.boolean());
    value.unwrap_or(true)
}

fn logger(node: &Node<'_>) -> Logger {
    let sink = node
        .attribute("type")
        .and_then(|value| value.choice(&[("file", "file"), ("cout", "cout"), ("cerr", "cerr")]));
    Logger {
        name: attribute(node, "name"),
        sink: sink.unwrap_or_default().to_owned(),
        enabled: enabled(node),
        settings: finished_settings(node),
    }
}

fn deployment(node: &Node<'_>) -> Deployment {
    let mut load = LoadPolicy::default();
    for property in node.children("prop") {
        let is_load_type = property
            .required_attribute("name")
            .is_some_and(|name| name.choice(&[("load.type", ())]).is_some());
        let value = property.text();
        property.finish();
        if is_load_type {
            load = load_policy(&value).unwrap_or_default();
        }
    }
    let applications = node.children("app_load").into_iter().map(|application| {
        let name = application.text().located();
        application.finish();
        name
    });
    let applications = applications.collect();
    node.finish();
    Deployment { load, applications }
}

fn load_policy(value: &Value<'_>) -> Option<LoadPolicy> {
    value.choice(&[
        ("none", LoadPolicy::None),
        ("all", LoadPolicy::All),
        ("list", LoadPolicy::List),
    ])
}

fn component_manager(node: &Node<'_>, profile: &mut SystemProfile) {
    profile.local_node = node.value("local_node_id").map(|value| value.located());
    if let Some(map) = node.child("node_map") {
        profile.nodes = map.children("node").iter().map(node_address).collect();
        map.finish();
    }
    profile.io_workers = node.value("io_workers").and_then(|value| value.number());
    if let Some(workers) = node.child("nonblocking_workers") {
        let count = |name, default| {
            let value = workers.attribute(name);
            value.map_or(Some(default), |value| value.number())
        };
        profile.nonblocking_workers = count("min", 5).zip(count("max", 10));
        workers.pass_over_attributes(&["scalable"]);
        workers.finish();
    }
    if let Some(connector) = node.child("io_connector") {
        connector.pass_over(&["connection_handler", "event_processor"]);
        connector.finish();
    }
    node.finish();
}

fn node_address(node: &Node<'_>) -> NodeAddress {
    NodeAddress {
        id: required_attribute(node, "id"),
        protocol: attribute(node, "protocol"),
        settings: finished_settings(node),
    }
}

fn channel(node: &Node<'_>) -> Channel {
    Channel {
        id: required_attribute(node, "id"),
        protocol: attribute(node, "protocol"),
        role: attribute(node, "role"),
        enabled: enabled(node),
        settings: finished_settings(node),
    }
}
