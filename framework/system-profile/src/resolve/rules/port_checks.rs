//! Rules of ports: each on a port of the right kind and direction.

use std::time::Duration;

use system_model::profile::Located;
use system_model::rules::{FreshnessRule, PortChecks, PortRules, SafeValue, ValidityRule};
use system_model::specification::{Place, PortDirection, PortKind, PortSpecification};

use super::names::{Names, description};
use crate::problem::Severity;
use crate::resolve::Assembly;
use crate::suggest::quoted;

/// The rules of a component's ports, as far as they fit them.
pub(super) fn resolve(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    component: usize,
    ports: Vec<(Located<String>, PortChecks)>,
) -> Vec<PortRules> {
    let mut resolved = Vec::new();
    for (name, checks) in ports {
        let Some(port) = names.port(assembly, component, &name) else {
            continue;
        };
        check_kind(assembly, port, &checks);
        check_safe_values(assembly, &checks);
        if let Some(freshness) = &checks.freshness {
            check_age(assembly, names, component, &port.name, freshness);
        }
        resolved.push(PortRules {
            port: port.name.clone(),
            direction: port.direction,
            data_type: port.data_type.clone(),
            checks,
        });
    }
    resolved
}

fn check_kind(assembly: &Assembly<'_>, port: &PortSpecification, checks: &PortChecks) {
    let report = |place: &Place, what: &str, wanted: &str| {
        assembly.report_at(
            Severity::Error,
            place,
            format!(
                "{what} of the port {}, which is {}",
                quoted(&port.name),
                description(port)
            ),
            format!("{what} is a rule of {wanted}"),
        );
    };
    let is_data = port.kind == PortKind::Data;
    let is_input = is_data && port.direction == PortDirection::Input;
    let of_data = "data ports";
    let of_inputs = "input data ports";
    for rule in checks.validity.iter().filter(|_| !is_data) {
        report(&rule.place, "validity", of_data);
    }
    for rule in checks.rate_of_change.iter().filter(|_| !is_data) {
        report(&rule.place, "rate of change", of_data);
    }
    for rule in checks.stuck.iter().filter(|_| !is_data) {
        report(&rule.place, "a stuck value", of_data);
    }
    for rule in checks.freshness.iter().filter(|_| !is_input) {
        report(&rule.place, "freshness", of_inputs);
    }
    for rule in checks.safe_values.iter().filter(|_| !is_input) {
        report(&rule.place, "a safe value", of_inputs);
    }
}

/// What a port reads in an emergency must not itself be a symptom.
fn check_safe_values(assembly: &Assembly<'_>, checks: &PortChecks) {
    let concerns = |safe: &SafeValue, rule: &ValidityRule| {
        safe.field.is_none() || rule.field.is_none() || safe.field == rule.field
    };
    for safe in &checks.safe_values {
        let rules = checks.validity.iter();
        let violated = rules
            .filter(|rule| concerns(&safe.value, &rule.value))
            .find(|rule| !is_inside(safe.value.value, &rule.value));
        if let Some(rule) = violated {
            assembly.report_at(
                Severity::Error,
                &safe.place,
                format!("the safe value {} is not valid", safe.value.value),
                format!(
                    "the interval is at {}; write a value inside of it",
                    rule.place
                ),
            );
        }
    }
}

fn is_inside(value: f64, rule: &ValidityRule) -> bool {
    rule.minimum.is_none_or(|least| value >= least)
        && rule.maximum.is_none_or(|largest| value <= largest)
}

/// A maximal age that is shorter than the period of who writes is exceeded in every period.
fn check_age(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    component: usize,
    port: &str,
    rule: &Located<FreshnessRule>,
) {
    let connections = names.application.connections.iter();
    let sources = connections.filter(|connection| {
        connection.target.component == component && connection.target.port == port
    });
    let periods = sources.map(|connection| {
        let source = names.specification(connection.source.component);
        (source.execution.period, source)
    });
    let Some((period, source)) = periods.min_by_key(|(period, _)| *period) else {
        return;
    };
    if period > Duration::ZERO && rule.value.maximum_age < period {
        assembly.report_at(
            Severity::Warning,
            &rule.place,
            format!(
                "a maximal age of {:?}, but `{}` writes only every {period:?}",
                rule.value.maximum_age,
                quoted(&source.name)
            ),
            "the rule is violated all the time; write two or three periods of the writer",
        );
    }
}
