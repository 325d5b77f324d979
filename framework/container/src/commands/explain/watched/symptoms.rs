//! Symptoms of single rules, in words.

use fault_manager::{DetectorKind, Scope};
use system_model::rules::{
    DecisionRule, ExceptionClass, HeartbeatRule, MonitorRule, OverrunRule, PortRules, ReturnCodes,
};
use system_model::specification::PortDirection;

use super::time;

/// What a check of a port's data looks for.
pub fn of_port(port: &PortRules, kind: &DetectorKind) -> Option<String> {
    let name = &port.port;
    let checks = &port.checks;
    let data = match port.direction {
        PortDirection::Input => format!("what comes at its input {name}"),
        PortDirection::Output => format!("what it sends at {name}"),
    };
    let of = |field: &Option<String>| match field {
        Some(field) => format!("{field} of {data}"),
        None => format!("A field of {data}"),
    };
    Some(match kind {
        DetectorKind::Validity { rule, .. } => {
            let rule = &checks.validity.get(*rule)?.value;
            let limits = match (rule.minimum, rule.maximum) {
                (None, None) => "is no finite number".to_owned(),
                (Some(minimum), None) => format!("is no number or less than {minimum}"),
                (None, Some(maximum)) => format!("is no number or more than {maximum}"),
                (Some(minimum), Some(maximum)) => {
                    format!("is no number or not between {minimum} and {maximum}")
                }
            };
            capital(&format!("{} {limits}", of(&rule.field)))
        }
        DetectorKind::Freshness { .. } => {
            let rule = &checks.freshness.as_ref()?.value;
            let safe = checks
                .safe_values
                .iter()
                .map(|safe| match &safe.value.field {
                    Some(field) => format!("{field} = {}", safe.value.value),
                    None => safe.value.value.to_string(),
                });
            let safe: Vec<String> = safe.collect();
            let safe = match safe.as_slice() {
                [] => String::new(),
                values => format!("; it reads {} meanwhile", values.join(", ")),
            };
            let age = time(rule.maximum_age);
            format!("Nothing new comes at its input {name} for more than {age}{safe}")
        }
        DetectorKind::RateOfChange { rule, .. } => {
            let rule = &checks.rate_of_change.get(*rule)?.value;
            let rate = rule.maximum_per_second;
            capital(&format!(
                "{} changes by more than {rate} a second",
                of(&rule.field)
            ))
        }
        DetectorKind::Stuck { rule, .. } => {
            let rule = &checks.stuck.get(*rule)?.value;
            match &rule.field {
                Some(field) => capital(&format!(
                    "{field} of {data} is the same {} times",
                    rule.count
                )),
                None => capital(&format!("{data} is the same {} times", rule.count)),
            }
        }
        _ => return None,
    })
}

/// What counts as too many overruns.
pub fn overrun(rule: &OverrunRule) -> String {
    format!(
        "Its executor overruns its period more than {} times within {}",
        rule.tolerated,
        time(rule.within)
    )
}

/// What counts as no sign of life.
pub fn heartbeat(rule: &HeartbeatRule) -> String {
    format!(
        "It completes no cycle in {} periods of {} after each other",
        rule.missed,
        time(rule.period)
    )
}

/// What a process model compares.
pub fn model(scope: &Scope, monitor: &MonitorRule) -> String {
    let rule = &monitor.rule.value;
    let ports = monitor.outputs.iter().map(|port| {
        let component = &scope.specification.components[port.component].name;
        match &port.field {
            Some(field) => format!("{field} of {component}.{}", port.port),
            None => format!("{component}.{}", port.port),
        }
    });
    let ports: Vec<String> = ports.collect();
    let method = match rule.method {
        DecisionRule::Window => "the mean difference",
        DecisionRule::Cusum { .. } => "the summed-up difference (CUSUM)",
        DecisionRule::ChiSquare => "the chi-square of the difference",
    };
    format!(
        "Monitor {}: {} differs from what the model {} says: {method} exceeds {}",
        monitor.name,
        ports.join(", "),
        rule.model,
        rule.threshold
    )
}

/// Which exceptions a class has.
pub fn class(class: ExceptionClass) -> String {
    match class {
        ExceptionClass::Any => "Any exception".to_owned(),
        ExceptionClass::Kind(kind) => format!("Of these, {kind}"),
        ExceptionClass::ReturnCodes(codes) => {
            let codes = match codes {
                ReturnCodes::Caller => "400 to 499, the caller's mistake".to_owned(),
                ReturnCodes::Callee => "500 to 599, its own mistake".to_owned(),
                ReturnCodes::Unrecoverable => "0x1..., unrecoverable".to_owned(),
                ReturnCodes::Recoverable => "0x2..., recoverable".to_owned(),
                ReturnCodes::Code(code) => code.to_string(),
            };
            format!("Of these, a callback that returns {codes}")
        }
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    // Names stay as they are written.
    match letters.next() {
        Some(first) if text.starts_with("what ") => first.to_uppercase().chain(letters).collect(),
        _ => text.to_owned(),
    }
}
