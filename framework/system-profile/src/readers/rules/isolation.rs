//! `isolation`: where a component runs, and the bounds of a process of its own.

use system_model::profile::Located;
use system_model::rules::{IsolationRule, IsolationTier, ProcessLimits};

use super::measure::{count, located};
use crate::node::Node;
use crate::suggest::quoted;

/// Attributes that mean something for a process only.
const OF_PROCESSES: [&str; 5] = [
    "group",
    "memory_limit_kb",
    "open_files",
    "processor_time_s",
    "system_call_filter",
];

/// `isolation`.
pub(super) fn isolation(node: &Node<'_>) -> Option<Located<IsolationRule>> {
    let node = node.child("isolation")?;
    let tier = node.text().choice(&[
        ("guarded", IsolationTier::Guarded),
        ("process", IsolationTier::Process),
    ]);
    if tier == Some(IsolationTier::Guarded) {
        refuse_of_guarded(&node);
    }
    let bound = |name, least| node.attribute(name).and_then(|value| count(&value, least));
    let filter = node.attribute("system_call_filter");
    let limits = ProcessLimits {
        memory_bytes: bound("memory_limit_kb", 1).map(|kb| u64::from(kb) * 1024),
        open_files: bound("open_files", LEAST_FILES).map(u64::from),
        processor_time_s: bound("processor_time_s", 1).map(u64::from),
        filters_system_calls: filter.is_none_or(|value| value.boolean().unwrap_or(true)),
    };
    let group = node.attribute("group");
    let group = group.map(|group| group.as_str().to_owned());
    node.finish();
    let rule = IsolationRule {
        tier: tier?,
        group,
        limits,
    };
    Some(located(&node, rule))
}

/// What a host needs itself: its lines to the container, the library, and a few that loading takes.
const LEAST_FILES: u32 = 16;

fn refuse_of_guarded(node: &Node<'_>) {
    for name in OF_PROCESSES {
        let Some(value) = node.attribute(name) else {
            continue;
        };
        value.error(
            format!(
                "{name} `{}` of a component that is guarded",
                quoted(value.as_str())
            ),
            Some("only a process of its own has that; write process".into()),
        );
    }
}
