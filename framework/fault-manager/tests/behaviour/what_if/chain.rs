//! Three components in a chain, and rules about their data.

use std::time::Duration;

use fault_manager::Scope;
use system_model::rules::{FreshnessRule, Judgement, PortChecks, PortRules, ValidityRule};
use system_model::specification::{
    ConnectionSpecification, Place, PortDirection, PortKind, PortReference, PortSpecification,
    QueuePolicy,
};

use crate::support::{application, located};

fn port(name: &str, direction: PortDirection) -> PortSpecification {
    PortSpecification {
        name: name.to_owned(),
        kind: PortKind::Data,
        direction,
        data_type: "Number".to_owned(),
        queue: QueuePolicy::Last,
        queue_size: 1,
        place: Place::default(),
    }
}

/// `source` sends from `out` to `in` of `filter`, that from `out` to `in` of `sink`.
pub fn chain() -> Scope {
    let mut scope = application("chain", &["source", "filter", "sink"]);
    for (index, ports) in [&["out"][..], &["in", "out"], &["in"]].iter().enumerate() {
        let direction = |name: &str| match name {
            "in" => PortDirection::Input,
            _ => PortDirection::Output,
        };
        let ports = ports.iter().map(|name| port(name, direction(name)));
        scope.specification.components[index].ports = ports.collect();
    }
    for source in [0, 1] {
        let end = |component: usize, port: &str| PortReference {
            component,
            port: port.to_owned(),
        };
        scope
            .specification
            .connections
            .push(ConnectionSpecification {
                kind: PortKind::Data,
                source: end(source, "out"),
                target: end(source + 1, "in"),
                place: Place::default(),
            });
    }
    scope
}

/// Lets rules look at a port.
pub fn watch(scope: &mut Scope, component: usize, port: &str, checks: PortChecks) {
    scope.rules.components[component].ports.push(PortRules {
        port: port.to_owned(),
        direction: match port {
            "in" => PortDirection::Input,
            _ => PortDirection::Output,
        },
        data_type: "Number".to_owned(),
        checks,
    });
}

pub fn validity() -> PortChecks {
    PortChecks {
        validity: vec![located(ValidityRule {
            field: None,
            minimum: Some(0.0),
            maximum: Some(1.0),
            judgement: Judgement::default(),
        })],
        ..PortChecks::default()
    }
}

pub fn freshness(milliseconds: u64) -> PortChecks {
    PortChecks {
        freshness: Some(located(FreshnessRule {
            maximum_age: Duration::from_millis(milliseconds),
            judgement: Judgement::default(),
        })),
        ..PortChecks::default()
    }
}
