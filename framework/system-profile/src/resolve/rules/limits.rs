//! Rules that contradict how a component runs: they could never be met, or never be violated.

use std::time::Duration;

use system_model::profile::Located;
use system_model::rules::{
    ComponentRules, FaultRule, FaultRules, HeartbeatRule, IsolationTier, OverrunRule, Preload,
    declared_replacement_cost, declared_reset_cost,
};
use system_model::specification::{ComponentSpecification, ExecutionKind, Place};

use super::names::Names;
use crate::problem::Severity;
use crate::resolve::Assembly;
use crate::suggest::quoted;

/// Checks the rules of all components and executors.
pub(super) fn check(assembly: &Assembly<'_>, names: &Names<'_>, rules: &FaultRules) {
    for (component, own) in names.application.components.iter().zip(&rules.components) {
        check_overrun(assembly, component, own.overrun.as_ref());
        check_heartbeat(assembly, component, own.heartbeat.as_ref());
        check_backup(assembly, component, own);
        check_actuator(assembly, component, own);
        let fault = own.fault.as_ref().or(rules.fault.as_ref());
        let fault = fault.map(|fault| fault.value).unwrap_or_default();
        check_standby(assembly, component, own, fault);
        check_recovery(assembly, own, fault);
    }
    for executor in &rules.executors {
        let first = names.specification(executor.first_component);
        check_overrun(assembly, first, executor.overrun.as_ref());
        check_heartbeat(assembly, first, executor.heartbeat.as_ref());
    }
}

fn check_overrun(
    assembly: &Assembly<'_>,
    component: &ComponentSpecification,
    rule: Option<&Located<OverrunRule>>,
) {
    if let Some(rule) = rule.filter(|_| component.execution.period.is_zero()) {
        assembly.report_at(
            Severity::Error,
            &rule.place,
            format!(
                "`{}` has no period that it could overrun",
                quoted(&component.name)
            ),
            "overruns are those of periodic components; use a watchdog for others",
        );
    }
}

fn check_heartbeat(
    assembly: &Assembly<'_>,
    component: &ComponentSpecification,
    rule: Option<&Located<HeartbeatRule>>,
) {
    let Some(rule) = rule else {
        return;
    };
    let period = component.execution.period;
    if component.execution.kind == ExecutionKind::Passive {
        assembly.report_at(
            Severity::Error,
            &rule.place,
            format!(
                "`{}` is passive: it has no heartbeat",
                quoted(&component.name)
            ),
            "heartbeats count completed executions, and a passive component is never executed",
        );
    } else if rule.value.period < period {
        assembly.report_at(
            Severity::Warning,
            &rule.place,
            format!(
                "a heartbeat every {:?} of a component that runs every {period:?}",
                rule.value.period
            ),
            "some periods are empty even if all is well; write a heartbeat of several periods",
        );
    }
}

fn check_backup(
    assembly: &Assembly<'_>,
    component: &ComponentSpecification,
    rules: &ComponentRules,
) {
    let Some(resurrect) = &rules.resurrect else {
        return;
    };
    let period = component.execution.period;
    if let Some(backup) = resurrect.value.backup.filter(|backup| *backup < period) {
        assembly.report_at(
            Severity::Warning,
            &resurrect.place,
            format!("a backup every {backup:?} of a component that runs every {period:?}"),
            "nothing changes between two executions; write a multiple of the component's period",
        );
    }
}

/// A standby of the component itself takes over where it is reset and cannot be called any more.
fn check_standby(
    assembly: &Assembly<'_>,
    component: &ComponentSpecification,
    rules: &ComponentRules,
    fault: FaultRule,
) {
    if let Some(standby) = rules.standby.as_ref().filter(|_| !resets(rules, fault)) {
        assembly.report_at(
            Severity::Error,
            &standby.place,
            format!(
                "a standby of `{}`, which is never reset",
                quoted(&component.name)
            ),
            "nobody would take over; allow resets (<resurrect>, <retry_max>), or remove <standby>",
        );
    }
}

fn resets(rules: &ComponentRules, fault: FaultRule) -> bool {
    let may_reset = rules.resurrect.as_ref().is_none_or(|rule| rule.value.reset);
    may_reset && fault.retry_max > 0
}

fn check_actuator(
    assembly: &Assembly<'_>,
    component: &ComponentSpecification,
    rules: &ComponentRules,
) {
    let Some(actuator) = &rules.actuator else {
        return;
    };
    if rules
        .ports
        .iter()
        .all(|port| port.checks.safe_values.is_empty())
    {
        assembly.report_at(
            Severity::Warning,
            &actuator.place,
            format!(
                "no port of the actuator `{}` has a safe value",
                quoted(&component.name)
            ),
            "in an emergency stop its commands would stay as they are; write \
             <command port=\"…\" safe_value=\"0\"/> in <actuator>",
        );
    }
}

/// Each rung of the ladder must fit into the deadline by itself: a rung that fails starts the next
/// one, with a deadline of its own. The deadline counts from the detection of the fault, so the time
/// in which a watchdog waits is no part of it.
fn check_recovery(assembly: &Assembly<'_>, rules: &ComponentRules, fault: FaultRule) {
    let Some(recovery) = &rules.recovery else {
        return;
    };
    let deadline = recovery.value.deadline;
    let isolation = rules.isolation.as_ref();
    let tier = isolation.map_or(IsolationTier::default(), |rule| rule.value.tier);
    let report = |what: &str, cost: Duration, place: Option<&Place>| {
        let place = place.map(|place| format!(" (at {place})"));
        assembly.report_at(
            Severity::Warning,
            &recovery.place,
            format!("the deadline of {deadline:?} cannot be met by {what}, which takes {cost:?}"),
            format!(
                "write a longer deadline, a shorter backoff, or a warmer preload{}",
                place.unwrap_or_default()
            ),
        );
    };
    let pause = match fault.retry_max {
        0 | 1 => Duration::ZERO,
        _ => fault.backoff,
    };
    let reset = declared_reset_cost(tier).saturating_add(pause);
    if resets(rules, fault) && reset > deadline {
        report("a reset", reset, None);
    }
    for secondary in &rules.secondaries {
        let cost = declared_replacement_cost(secondary.preload, tier);
        if cost > deadline {
            let what = match secondary.preload {
                Preload::Cold => "a cold replacement",
                Preload::Loaded => "a loaded replacement",
                Preload::Warm => "a warm replacement",
            };
            report(what, cost, Some(&secondary.specification.place));
        }
    }
}
