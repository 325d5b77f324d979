//! Resources and their weights, thresholds, and how it is decided.

use std::ops::RangeInclusive;

use system_model::task::{
    DecisionOptions, GenerationOptions, HopCount, QualityPreferences, TaskResource,
};

use super::names::{bounded, declared};
use super::structure::AMOUNT;
use crate::node::Node;
use crate::readers::rules::measure::{duration, positive_duration};
use crate::readers::world::quantity::{attribute, within};

/// The paper has four; a list for people to weigh.
const MAX_RESOURCES: usize = 32;
/// α is above 0: with 0 nothing is feasible. A thousandth tells any two thresholds apart.
const FUNCTIONAL_WEIGHT: RangeInclusive<f64> = 0.001..=1.0;
/// A performance is at most 1; only what exceeds its threshold is feasible.
const THRESHOLD: RangeInclusive<f64> = 0.0..=0.999;
/// Each has to be estimated.
const LIMIT: RangeInclusive<u32> = 1..=10_000;
/// More bad evaluations than a minute has at 1 kHz.
const CONFIRM: RangeInclusive<u32> = 1..=60_000;
/// What has to be ten times as good is never taken.
const HYSTERESIS: RangeInclusive<f64> = 0.0..=10.0;

pub(super) fn resources(root: &Node<'_>) -> Vec<TaskResource> {
    let Some(list) = root.child("resources") else {
        return Vec::new();
    };
    let mut known = Vec::new();
    let nodes = bounded(list.children("resource"), MAX_RESOURCES);
    let resources = nodes.iter().map(|node| {
        let name = declared(node, &mut known);
        let unit = node.attribute("unit");
        let weight = node.attribute("weight");
        let weight = weight.and_then(|value| within(&value, &AMOUNT));
        node.finish();
        TaskResource {
            name: name.unwrap_or_default(),
            unit: unit.map_or_else(String::new, |unit| unit.as_str().to_owned()),
            weight: weight.unwrap_or(1.0),
        }
    });
    let resources = resources.collect();
    list.finish();
    resources
}

pub(super) fn quality(root: &Node<'_>) -> Option<QualityPreferences> {
    let node = root.required_child("quality")?;
    let weight = node.attribute("functional_weight");
    let weight = weight.map_or(Some(1.0), |value| within(&value, &FUNCTIONAL_WEIGHT));
    let functional = attribute(&node, "functional_threshold", THRESHOLD);
    let non_functional = attribute(&node, "non_functional_threshold", THRESHOLD);
    node.finish();
    let (weight, functional) = (weight?, functional?);
    if functional >= weight {
        node.error(
            "no functional performance can exceed this threshold",
            Some(format!(
                "it is at most the functional_weight, {weight}; write a threshold below it"
            )),
        );
        return None;
    }
    Some(QualityPreferences {
        functional_weight: weight,
        functional_threshold: functional,
        non_functional_threshold: non_functional?,
    })
}

pub(super) fn generation(root: &Node<'_>) -> Option<GenerationOptions> {
    let usual = GenerationOptions::default();
    let Some(node) = root.child("generation") else {
        return Some(usual);
    };
    let hops = node.attribute("hops").map(|value| {
        value.choice(&[HopCount::Whole, HopCount::Essential].map(|it| (it.name(), it)))
    });
    let running = node.attribute("running");
    let running = running.map(|value| value.choice(&[("judged", true), ("left_out", false)]));
    let limit = node.attribute("limit").map(|value| within(&value, &LIMIT));
    node.finish();
    Some(GenerationOptions {
        hops: hops.unwrap_or(Some(usual.hops))?,
        judges_running: running.unwrap_or(Some(usual.judges_running))?,
        limit: match limit {
            Some(limit) => usize::try_from(limit?).ok()?,
            None => usual.limit,
        },
    })
}

pub(super) fn decision(root: &Node<'_>) -> Option<DecisionOptions> {
    let usual = DecisionOptions::default();
    let Some(node) = root.child("decision") else {
        return Some(usual);
    };
    let confirm = node.attribute("confirm").map(|it| within(&it, &CONFIRM));
    let dwell = node.attribute("dwell").map(|it| duration(&it));
    let hysteresis = node
        .attribute("hysteresis")
        .map(|it| within(&it, &HYSTERESIS));
    let [estimation, reconfiguration, evaluation] = [
        "estimation_deadline",
        "reconfiguration_deadline",
        "evaluation_period",
    ]
    .map(|name| node.attribute(name).map(|it| positive_duration(&it)));
    node.finish();
    Some(DecisionOptions {
        confirm: confirm.unwrap_or(Some(usual.confirm))?,
        dwell: dwell.unwrap_or(Some(usual.dwell))?,
        hysteresis: hysteresis.unwrap_or(Some(usual.hysteresis))?,
        estimation_deadline: estimation.unwrap_or(Some(usual.estimation_deadline))?,
        reconfiguration_deadline: reconfiguration
            .unwrap_or(Some(usual.reconfiguration_deadline))?,
        evaluation_period: evaluation.unwrap_or(Some(usual.evaluation_period))?,
    })
}
