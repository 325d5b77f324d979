//! `execution_semantics`: how a component is run.

use std::time::Duration;

use system_model::specification::{ExecutionKind, ExecutionSemantics, SchedulingPolicy};

use crate::node::Node;
use crate::value::Value;

/// Priorities of the real-time policies of POSIX that OPRoS uses.
const PRIORITIES: std::ops::RangeInclusive<i64> = 0..=99;

/// A longer period than a day is a mistake of unit.
const MAX_PERIOD_MILLISECONDS: i64 = 24 * 60 * 60 * 1000;

const TYPES: [(&str, ExecutionKind); 6] = [
    ("periodic", ExecutionKind::Periodic),
    ("aperiodic", ExecutionKind::Aperiodic),
    ("passive", ExecutionKind::Passive),
    ("periodic-shared", ExecutionKind::PeriodicShared),
    ("periodic-exclusive", ExecutionKind::Periodic),
    ("non-periodic", ExecutionKind::Aperiodic),
];

const PASSIVE: ExecutionSemantics = ExecutionSemantics {
    kind: ExecutionKind::Passive,
    period: Duration::ZERO,
    priority: 0,
    policy: SchedulingPolicy::Other,
};

/// What `execution_semantics` says beside the semantics itself.
#[derive(Debug, Default)]
pub(super) struct Remarks {
    pub(super) instance_creation: Option<String>,
    pub(super) lifecycle_type: Option<String>,
}

/// Reads the semantics of a component.
pub(super) fn read(component: &Node<'_>) -> (ExecutionSemantics, Remarks) {
    let Some(node) = component.child("execution_semantics") else {
        component.warning(
            "the component has no <execution_semantics> and is taken for passive",
            Some("a passive component is never executed; write <execution_semantics><type>passive</type></execution_semantics> if it is meant so".into()),
        );
        return (PASSIVE, Remarks::default());
    };
    let kind = kind(&node);
    let semantics = ExecutionSemantics {
        kind: kind.unwrap_or(ExecutionKind::Passive),
        period: period(&node, kind),
        priority: node.value("priority").map_or(0, |value| priority(&value)),
        policy: node
            .value("policy")
            .and_then(|value| policy(&value))
            .unwrap_or_default(),
    };
    let own = |value: Value<'_>| value.as_str().to_owned();
    let remarks = Remarks {
        instance_creation: node
            .value_of(&["instance_creation", "creation_type"])
            .map(own),
        lifecycle_type: node.value("lifecycle_type").map(own),
    };
    node.finish();
    (semantics, remarks)
}

fn kind(node: &Node<'_>) -> Option<ExecutionKind> {
    let value = node.required_value("type")?;
    if value.as_str() == "non-periodic" {
        value.warning(
            "`non-periodic` is an old name and is read as `aperiodic`",
            Some("write aperiodic".into()),
        );
    }
    value.choice(&TYPES)
}

/// The period in milliseconds. Passive and aperiodic components need none; a periodic one without
/// a period would be a busy loop and is refused.
fn period(node: &Node<'_>, kind: Option<ExecutionKind>) -> Duration {
    let value = node.value("period");
    let periodic = matches!(
        kind,
        Some(ExecutionKind::Periodic | ExecutionKind::PeriodicShared)
    );
    let help = || Some("write the period in milliseconds: <period>20</period>".to_owned());
    match value {
        Some(value) if !periodic => {
            // Not needed, but whoever writes nonsense is told.
            value.lenient_integer();
            Duration::ZERO
        }
        None if !periodic => Duration::ZERO,
        None => {
            node.error("a periodic component without a period", help());
            Duration::ZERO
        }
        Some(value) => {
            let milliseconds = value.lenient_integer();
            if (1..=MAX_PERIOD_MILLISECONDS).contains(&milliseconds) {
                return Duration::from_millis(milliseconds.unsigned_abs());
            }
            value.error(
                format!("a period of {milliseconds} ms is not from 1 ms to one day"),
                help(),
            );
            Duration::ZERO
        }
    }
}

fn priority(value: &Value<'_>) -> u8 {
    let wanted = value.lenient_integer();
    let priority = wanted.clamp(*PRIORITIES.start(), *PRIORITIES.end());
    if priority != wanted {
        value.warning(
            format!("priority {wanted} is read as {priority}"),
            Some("priorities go from 0, the lowest, to 99".into()),
        );
    }
    u8::try_from(priority).unwrap_or_default()
}

fn policy(value: &Value<'_>) -> Option<SchedulingPolicy> {
    value.choice(&[
        ("SCHED_OTHER", SchedulingPolicy::Other),
        ("SCHED_FIFO", SchedulingPolicy::Fifo),
        ("SCHED_RR", SchedulingPolicy::RoundRobin),
    ])
}
