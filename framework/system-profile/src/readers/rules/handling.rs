//! The elements that say what is done about a fault.

use std::time::Duration;

use system_model::profile::Located;
use system_model::rules::{
    ActuatorRule, AdaptRule, DEFAULT_HANDLE_DEADLINE, DEFAULT_PERSISTED_MAX_AGE, FaultRule,
    HandleRule, MAX_RETRY_MAX, PortChecks, Preload, RecoveryRule, ResurrectRule, StopCategory,
};

use super::declared::DeclaredSecondary;
use super::detection::safe_values;
use super::diagnosis::APPLICATION_SEVERITIES;
use super::measure::{duration, located, positive_duration, required, setting};
use super::safe_state::safe_state;
use crate::node::Node;
use crate::value::Value;

/// `resurrect`.
pub(super) fn resurrect(node: &Node<'_>) -> Option<Located<ResurrectRule>> {
    let node = node.child("resurrect")?;
    let reset = setting(&node, "reset").map(|value| value.boolean());
    let backup = node.child("backup").map(|backup| self::backup(&backup));
    node.finish();
    let reset = reset.unwrap_or(Some(false))?;
    let (period, persist) = match backup {
        Some(backup) => {
            let (period, persist) = backup?;
            (Some(period), persist)
        }
        None => (None, None),
    };
    if period.is_some() && !reset {
        node.error(
            "a backup of a component that is never reset",
            Some("nobody would restore it; write <reset>true</reset>, or remove <backup>".into()),
        );
        return None;
    }
    let rule = ResurrectRule {
        reset,
        backup: period,
        persist,
    };
    Some(located(&node, rule))
}

/// Its period, and how old a copy may be that the container itself goes on from.
fn backup(node: &Node<'_>) -> Option<(Duration, Option<Duration>)> {
    let period = positive_duration(&node.text());
    let persist = node.attribute("persist").map(|value| value.boolean());
    let max_age = node.attribute("max_age");
    node.finish();
    let persist = persist.unwrap_or(Some(false))?;
    if let Some(max_age) = max_age.as_ref().filter(|_| !persist) {
        max_age.error(
            "a greatest age of copies that do not outlive the container",
            Some("write persist=\"true\" as well, or remove max_age".into()),
        );
        return None;
    }
    let max_age = max_age.map(|value| positive_duration(&value));
    let max_age = max_age.unwrap_or(Some(DEFAULT_PERSISTED_MAX_AGE))?;
    Some((period?, persist.then_some(max_age)))
}

/// `fault`, and the secondaries in it.
pub(super) fn fault(node: &Node<'_>) -> (Option<Located<FaultRule>>, Vec<DeclaredSecondary>) {
    let Some(node) = node.child("fault") else {
        return (None, Vec::new());
    };
    let default = FaultRule::default();
    let or_default = |value: Option<Option<Duration>>, default| value.unwrap_or(Some(default));
    let retry_max = setting(&node, "retry_max").map(|value| retries(&value));
    let window = setting(&node, "window").map(|value| duration(&value));
    let backoff = setting(&node, "backoff").map(|value| duration(&value));
    let severity = setting(&node, "severity").map(|value| value.choice(&APPLICATION_SEVERITIES));
    let secondaries = node.children("secondary");
    let secondaries = secondaries.iter().filter_map(secondary).collect();
    node.finish();
    let rule = || {
        Some(FaultRule {
            retry_max: retry_max.unwrap_or(Some(default.retry_max))?,
            window: or_default(window, default.window)?,
            backoff: or_default(backoff, default.backoff)?,
            severity: severity.unwrap_or(Some(default.severity))?,
        })
    };
    let rule = rule().map(|rule| located(&node, rule));
    if let Some(rule) = rule.as_ref().filter(|rule| !rule.value.runs_out()) {
        report_endless(&node, &rule.value);
    }
    (rule, secondaries)
}

fn retries(value: &Value<'_>) -> Option<u32> {
    let number: u32 = value.number()?;
    if number > MAX_RETRY_MAX {
        value.error(
            format!("a budget of {number} resets"),
            Some(format!(
                "each may leave its instance in quarantine; write at most {MAX_RETRY_MAX}"
            )),
        );
        return None;
    }
    Some(number)
}

fn report_endless(node: &Node<'_>, rule: &FaultRule) {
    let pauses = rule.retry_max.saturating_sub(1);
    node.error(
        "this budget never runs out, so nothing after the resets is ever reached",
        Some(format!(
            "{} resets with pauses of {:?} take {:?}, and only those within {:?} are counted; write \
             a longer window or a shorter backoff",
            rule.retry_max,
            rule.backoff,
            rule.backoff.saturating_mul(pauses),
            rule.window
        )),
    );
}

/// How much is prepared, by name.
const PRELOADS: [(&str, Preload); 3] = [
    ("cold", Preload::Cold),
    ("loaded", Preload::Loaded),
    ("warm", Preload::Warm),
];

/// `standby`.
pub(super) fn standby(node: &Node<'_>) -> Option<Located<Preload>> {
    let node = node.child("standby")?;
    let preload = required(&node, "preload").and_then(|value| value.choice(&PRELOADS));
    node.finish();
    Some(located(&node, preload?))
}

fn secondary(node: &Node<'_>) -> Option<DeclaredSecondary> {
    let preload = node
        .attribute("preload")
        .map(|value| value.choice(&PRELOADS));
    let reference = match node.element().children.is_empty() {
        true => Some(node.text()).filter(|text| !text.is_empty()),
        false => node.value("reference"),
    };
    if reference.is_none() {
        node.error(
            "a secondary without a reference",
            Some("write <reference>…</reference> with the file of its profile".into()),
        );
    }
    node.finish();
    Some(DeclaredSecondary {
        reference: reference?.located(),
        preload: preload.unwrap_or(Some(Preload::default()))?,
    })
}

/// `recovery`.
pub(super) fn recovery(node: &Node<'_>) -> Option<Located<RecoveryRule>> {
    let node = node.child("recovery")?;
    let deadline = required(&node, "deadline").and_then(|value| positive_duration(&value));
    node.finish();
    Some(located(
        &node,
        RecoveryRule {
            deadline: deadline?,
        },
    ))
}

/// A command port, with its safe values.
type Command = (Located<String>, PortChecks);

/// `actuator`, and the command ports in it.
pub(super) fn actuator(node: &Node<'_>) -> (Option<Located<ActuatorRule>>, Vec<Command>) {
    let Some(node) = node.child("actuator") else {
        return (None, Vec::new());
    };
    let category = required(&node, "stop_category").and_then(|value| {
        value.choice(&[
            ("0", StopCategory::PowerOff),
            ("1", StopCategory::ControlledThenOff),
            ("2", StopCategory::Controlled),
        ])
    });
    let commands = node.children("command");
    let commands = commands.iter().filter_map(command).collect();
    let safe_states = node.children("safe_state");
    let safe_states = safe_states.iter().filter_map(safe_state).collect();
    node.finish();
    let rule = category.map(|stop_category| ActuatorRule {
        stop_category,
        safe_states,
    });
    (rule.map(|rule| located(&node, rule)), commands)
}

fn command(node: &Node<'_>) -> Option<Command> {
    let port = node.required_attribute("port");
    let checks = PortChecks {
        safe_values: safe_values(node),
        ..PortChecks::default()
    };
    node.finish();
    if checks.safe_values.is_empty() {
        node.error(
            "a command port without a safe value",
            Some("write safe_value=\"0\", or <safe_value field=\"…\">…</safe_value> in it".into()),
        );
    }
    Some((port?.located(), checks))
}

/// `handle`: the tree that handles the fault.
pub(super) fn handle(node: &Node<'_>) -> Option<Located<HandleRule>> {
    let node = node.child("handle")?;
    let tree = node.required_attribute("tree");
    let deadline = node.attribute("deadline");
    let deadline = deadline.map(|value| positive_duration(&value));
    node.finish();
    let rule = HandleRule {
        tree: tree?.as_str().to_owned(),
        deadline: deadline.unwrap_or(Some(DEFAULT_HANDLE_DEADLINE))?,
    };
    Some(located(&node, rule))
}

/// The task that is done in another way.
pub(super) fn adapt(node: &Node<'_>) -> Option<Located<AdaptRule>> {
    let node = node.child("adapt")?;
    let task = node.required_attribute("task");
    let robot = node.attribute("robot");
    node.finish();
    let rule = AdaptRule {
        task: task?.as_str().to_owned(),
        robot: robot.map(|robot| robot.as_str().to_owned()),
    };
    Some(located(&node, rule))
}
