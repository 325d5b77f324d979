//! The elements that bound how a component works: its time, its rhythm, its memory.

use system_model::profile::Located;
use system_model::rules::{
    DEFAULT_HEARTBEATS_MISSED, DEFAULT_STARTUP, HeartbeatRule, MemoryRule, OverrunRule,
    WatchdogRule,
};

use super::detection::judgement;
use super::measure::{count, located, positive_duration, required, setting};
use crate::node::Node;

/// Bytes of a kilobyte, as the kernel counts them for `ps` and `top`.
const KILOBYTE: u64 = 1024;

/// `watchdog`.
pub(super) fn watchdog(node: &Node<'_>) -> Option<Located<WatchdogRule>> {
    let node = node.child("watchdog")?;
    let time = |name| setting(&node, name).and_then(|value| positive_duration(&value));
    let rule = WatchdogRule {
        deadline: time("deadline"),
        startup: time("startup").unwrap_or(DEFAULT_STARTUP),
        judgement: judgement(&node),
    };
    node.finish();
    Some(located(&node, rule))
}

/// `overrun`.
pub(super) fn overrun(node: &Node<'_>) -> Option<Located<OverrunRule>> {
    let node = node.child("overrun")?;
    let tolerated = required(&node, "tolerated").and_then(|value| count(&value, 0));
    let within = required(&node, "within").and_then(|value| positive_duration(&value));
    let judgement = judgement(&node);
    node.finish();
    let rule = OverrunRule {
        tolerated: tolerated?,
        within: within?,
        judgement,
    };
    Some(located(&node, rule))
}

/// `heartbeat`.
pub(super) fn heartbeat(node: &Node<'_>) -> Option<Located<HeartbeatRule>> {
    let node = node.child("heartbeat")?;
    let period = required(&node, "period").and_then(|value| positive_duration(&value));
    let missed = setting(&node, "missed").map(|value| count(&value, 1));
    let judgement = judgement(&node);
    node.finish();
    let rule = HeartbeatRule {
        period: period?,
        missed: missed.unwrap_or(Some(DEFAULT_HEARTBEATS_MISSED))?,
        judgement,
    };
    Some(located(&node, rule))
}

/// `memory`.
pub(super) fn memory(node: &Node<'_>) -> Option<Located<MemoryRule>> {
    let node = node.child("memory")?;
    let limit = required(&node, "limit_kb").and_then(|value| count(&value, 1));
    let judgement = judgement(&node);
    node.finish();
    let rule = MemoryRule {
        limit_bytes: u64::from(limit?) * KILOBYTE,
        judgement,
    };
    Some(located(&node, rule))
}
