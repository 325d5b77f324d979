//! What stands in a box beside its name.

use std::time::Duration;

use fault_manager::Scope;
use system_model::rules::{
    DecisionRule, DependencyRule, Entity, IsolationTier, Preload, ProcessModelRule, StopCategory,
    VotingMethod, VotingRule,
};
use system_model::specification::{ExecutionKind, ExecutionSemantics};

/// Type, rhythm, tier, what it moves, what stands ready for it, what it needs.
pub fn component(scope: &Scope, index: usize) -> Vec<String> {
    let specification = &scope.specification.components[index];
    let rules = &scope.rules.components[index];
    let mut notes = Vec::new();
    if specification.type_name != specification.name {
        notes.push(format!("type {}", specification.type_name));
    }
    let tier = match rules.isolation.as_ref().map(|rule| &rule.value) {
        Some(isolation) if isolation.tier == IsolationTier::Process => match &isolation.group {
            Some(group) => format!("process {group}"),
            None => "process".to_owned(),
        },
        _ => "guarded".to_owned(),
    };
    notes.push(format!("{}, {tier}", rhythm(&specification.execution)));
    if let Some(rule) = &rules.actuator {
        let category = match rule.value.stop_category {
            StopCategory::PowerOff => 0,
            StopCategory::ControlledThenOff => 1,
            StopCategory::Controlled => 2,
        };
        notes.push(format!("actuator, stop category {category}"));
    }
    if let Some(rule) = &rules.standby {
        notes.push(format!("standby, {}", preload(rule.value)));
    }
    notes.extend(rules.secondaries.iter().map(|secondary| {
        let (name, preload) = (
            &secondary.specification.type_name,
            preload(secondary.preload),
        );
        format!("secondary {name}, {preload}")
    }));
    let dependencies = scope.rules.dependencies.iter().map(|rule| &rule.value);
    let own = dependencies.filter(|rule| rule.dependent.entity == Entity::Component(index));
    notes.extend(own.flat_map(needs));
    notes
}

/// A line for each provider; the first says how many are needed.
fn needs(rule: &DependencyRule) -> Vec<String> {
    let providers = rule.providers.iter().map(|provider| provider.name.as_str());
    let names: Vec<&str> = providers.collect();
    let lines = names.chunks(2).map(|two| two.join(", "));
    let mut lines: Vec<String> = lines.collect();
    let first = match rule.need < names.len() {
        true => format!("needs {} of ", rule.need),
        false => "needs ".to_owned(),
    };
    if let Some(line) = lines.first_mut() {
        line.insert_str(0, &first);
    }
    lines
}

/// How an executor runs.
pub fn rhythm(execution: &ExecutionSemantics) -> String {
    let period = milliseconds(execution.period);
    let kind = match execution.kind {
        ExecutionKind::Passive => return "passive".to_owned(),
        ExecutionKind::Aperiodic => "aperiodic".to_owned(),
        ExecutionKind::Periodic => format!("periodic {period}"),
        ExecutionKind::PeriodicShared => format!("shared {period}"),
    };
    format!("{kind}, priority {}", execution.priority)
}

/// Model and decision rule.
pub fn process_model(rule: &ProcessModelRule) -> Vec<String> {
    let method = match rule.method {
        DecisionRule::Window => "window",
        DecisionRule::Cusum { .. } => "CUSUM",
        DecisionRule::ChiSquare => "chi-square",
    };
    let model = rule.model.rsplit('/').next().unwrap_or(&rule.model);
    vec![
        format!("process model {model}"),
        format!("{method}, threshold {}", rule.threshold),
    ]
}

/// Method and tolerance.
pub fn voter(rule: &VotingRule) -> Vec<String> {
    let method = match rule.method {
        VotingMethod::Median => "median",
        VotingMethod::Majority => "majority",
        VotingMethod::Weighted => "weighted mean",
    };
    vec![format!(
        "{method} of {}, tolerance {}",
        rule.of, rule.tolerance
    )]
}

fn preload(preload: Preload) -> &'static str {
    match preload {
        Preload::Cold => "cold",
        Preload::Loaded => "loaded",
        Preload::Warm => "warm",
    }
}

fn milliseconds(time: Duration) -> String {
    format!("{} ms", time.as_secs_f64() * 1e3)
}
