//! `fault_rules`, and the same elements where they stand inline in profiles: each rule typed, names
//! as written. What the names mean is found out by `resolve::rules`.

mod conduct;
mod declared;
mod detection;
mod diagnosis;
mod handling;
mod isolation;
pub(super) mod measure;
mod monitor;
mod safe_state;

use system_model::profile::Located;
use system_model::rules::{ComponentRules, HeartbeatRule, PortChecks};

use super::header::required_attribute;
use crate::node::Node;
use crate::tree::Element;

pub(crate) use declared::{
    DeclaredApplication, DeclaredComponent, DeclaredDependency, DeclaredEnd, DeclaredExecutor,
    DeclaredMonitor, DeclaredName, DeclaredRules, DeclaredSecondary, DeclaredSource,
    DeclaredVoting, EntityKind,
};
pub(in crate::readers) use diagnosis::COMPONENT_SEVERITIES;

/// The outermost element of a rule file.
pub(crate) const RULES_ROOT: &str = "fault_rules";

/// As many elements as a rule for each of some twenty ports or exceptions of every component of the
/// largest application needs; merging compares rules with each other.
const MAX_RULE_ELEMENTS: usize = 20_000;

/// Reads a rule file.
pub(crate) fn read(root: &Node<'_>) -> Option<DeclaredRules> {
    let elements = count(root.element());
    if elements > MAX_RULE_ELEMENTS {
        root.error(
            format!("{elements} elements of rules; at most {MAX_RULE_ELEMENTS} are read"),
            Some("split the application, or write one rule for several fields".into()),
        );
        return None;
    }
    let mut rules = DeclaredRules::new(required_attribute(root, "application"));
    for node in root.children("component") {
        let component = component(&node);
        rules.take(component);
    }
    for node in root.children("composite") {
        rules.votings.extend(composite(&node));
    }
    rules.executors = root.children("executor").iter().map(executor).collect();
    rules.nodes = root
        .children("node")
        .iter()
        .filter_map(network_node)
        .collect();
    rules.applications = root
        .children("application")
        .iter()
        .map(application)
        .collect();
    for node in root.children("monitor") {
        monitor(&node, &mut rules);
    }
    rules.own = application_elements(root);
    rules.dependencies.extend(dependencies(root, None));
    root.pass_over(&["name", "version", "description", "copyright"]);
    root.pass_over_attributes(&["name", "version"]);
    root.finish();
    Some(rules)
}

fn count(element: &Element) -> usize {
    1 + element.children.iter().map(count).sum::<usize>()
}

fn component(node: &Node<'_>) -> DeclaredComponent {
    let name = required_attribute(node, "name");
    let mut component = component_elements(node, &name);
    component.place = node.place();
    node.pass_over(&["description"]);
    node.pass_over_attributes(&["description"]);
    node.finish();
    component
}

/// The rules that stand directly in an element: a `component` of a rule file, a component profile or
/// a subcomponent.
pub(crate) fn component_elements(node: &Node<'_>, name: &Located<String>) -> DeclaredComponent {
    let ports = node.children("port").into_iter().map(|port| {
        let port_name = required_attribute(&port, "name");
        let checks = port_elements(&port);
        port.finish();
        (port_name, checks)
    });
    let mut ports: Vec<(Located<String>, PortChecks)> = ports.collect();
    let (actuator, commands) = handling::actuator(node);
    ports.extend(commands);
    let (fault, secondaries) = handling::fault(node);
    let rules = ComponentRules {
        severity: diagnosis::component_severity(node),
        confirmation: detection::confirmation_rule(node),
        exceptions: detection::exceptions(node),
        fault_events: detection::fault_events(node),
        watchdog: conduct::watchdog(node),
        overrun: conduct::overrun(node),
        heartbeat: conduct::heartbeat(node),
        memory: conduct::memory(node),
        ports: Vec::new(),
        resurrect: handling::resurrect(node),
        fault,
        standby: handling::standby(node),
        secondaries: Vec::new(),
        recovery: handling::recovery(node),
        actuator,
        isolation: isolation::isolation(node),
        adapt: handling::adapt(node),
        handle: handling::handle(node),
    };
    // Evaluators and estimators belong to the task adaptation, which reads them itself.
    node.pass_over(&["evaluator", "estimator"]);
    DeclaredComponent {
        name: name.clone(),
        place: node.place(),
        rules,
        ports,
        secondaries,
        dependencies: dependencies(node, Some(name)),
        monitors: monitor::process_models(node, name, Some(name)),
        votings: monitor::votings(node, name, Some(name)),
    }
}

/// The checks that stand in a port, in a rule file or inline.
pub(crate) fn port_elements(node: &Node<'_>) -> PortChecks {
    let (freshness, safe_values) = detection::freshness(node);
    PortChecks {
        validity: detection::validity(node),
        freshness,
        rate_of_change: detection::rate_of_change(node),
        stuck: detection::stuck(node),
        safe_values,
    }
}

/// The voters of a composite; its members are named without its own name.
fn composite(node: &Node<'_>) -> Vec<DeclaredVoting> {
    let name = required_attribute(node, "name");
    let votings = composite_elements(node, &name, &format!("{}/", name.value));
    node.finish();
    votings
}

/// The voters that stand in a composite whose members' names begin with `prefix`.
pub(crate) fn composite_elements(
    node: &Node<'_>,
    name: &Located<String>,
    prefix: &str,
) -> Vec<DeclaredVoting> {
    let mut votings = monitor::votings(node, name, None);
    for voting in &mut votings {
        let sources = voting.sources.iter_mut().map(|source| &mut source.end);
        for end in sources.chain(&mut voting.output) {
            end.component.value.insert_str(0, prefix);
        }
    }
    votings
}

fn executor(node: &Node<'_>) -> DeclaredExecutor {
    let executor = DeclaredExecutor {
        name: required_attribute(node, "name"),
        overrun: conduct::overrun(node),
        heartbeat: conduct::heartbeat(node),
    };
    node.finish();
    executor
}

fn network_node(node: &Node<'_>) -> Option<(Located<String>, Located<HeartbeatRule>)> {
    let name = required_attribute(node, "name");
    let heartbeat = conduct::heartbeat(node);
    node.finish();
    Some((name, heartbeat?))
}

fn application(node: &Node<'_>) -> DeclaredApplication {
    let name = required_attribute(node, "name");
    let mut application = application_elements(node);
    application.dependencies = dependencies(node, Some(&name));
    application.name = Some(name);
    node.finish();
    application
}

/// The rules of an application that stand directly in an element.
pub(crate) fn application_elements(node: &Node<'_>) -> DeclaredApplication {
    let (fault, secondaries) = handling::fault(node);
    DeclaredApplication {
        name: None,
        heartbeat: conduct::heartbeat(node),
        adapt: handling::adapt(node),
        fault,
        secondaries,
        dependencies: Vec::new(),
    }
}

/// The dependencies that stand in an element; `dependent` where they need not name it.
pub(crate) fn dependencies(
    node: &Node<'_>,
    dependent: Option<&Located<String>>,
) -> Vec<DeclaredDependency> {
    let found = node.children("dependency");
    found
        .iter()
        .filter_map(|node| diagnosis::dependency(node, dependent))
        .collect()
}

fn monitor(node: &Node<'_>, rules: &mut DeclaredRules) {
    let name = required_attribute(node, "name");
    let models = monitor::process_models(node, &name, None);
    let votings = monitor::votings(node, &name, None);
    let holds = |name: &str| node.element().child(name).is_some();
    if !holds("process_model") && !holds("voting") {
        node.error(
            "a monitor without anything that it could monitor by",
            Some("write <process_model> or <voting> in it".into()),
        );
    }
    rules.monitors.extend(models);
    rules.votings.extend(votings);
    node.finish();
}
