//! Lets a component of a running application fail again and again, and prints how long it was from
//! each fault to the first completed callback of its successor, beside what a bare trap takes on a
//! thread like that, and how often the container allocated meanwhile.
//!
//! A program of its own, because the allocator and the scheduling belong to a whole process. In the
//! same thread as the component that fails another one walks over memory in every cycle, so that
//! each fault finds cold caches; each comes four cycles of 1 ms after the one before.
#![allow(unsafe_code)] // an allocator that counts

mod allocations;
mod application;
mod floor;

use std::path::PathBuf;

use serde_json::{Value, json};

use allocations::Recording;

#[global_allocator]
static ALLOCATOR: Recording = Recording;

/// What is to be measured.
pub struct Plan {
    /// The folder with the component libraries.
    pub libraries: PathBuf,
    /// Elements of the rules of the component that fails.
    pub rules: String,
    /// Kind of fault, as injections name it.
    pub fault: String,
    /// How often it fails.
    pub faults: usize,
    /// Scheduling policy of the executor.
    pub policy: String,
    /// How much memory is walked over between faults, in KiB.
    pub walks_kib: usize,
}

impl Plan {
    /// Arguments: folder, rules, fault, number of faults, policy, KiB.
    fn from_arguments() -> Self {
        let mut arguments = std::env::args().skip(1);
        let mut next = |what: &str| arguments.next().unwrap_or_else(|| panic!("no {what}"));
        Self {
            libraries: next("folder").into(),
            rules: next("rules"),
            fault: next("fault"),
            faults: next("number").parse().expect("a number of faults"),
            policy: next("policy"),
            walks_kib: next("KiB").parse().expect("a number of KiB"),
        }
    }
}

fn main() {
    let plan = Plan::from_arguments();
    // First, so that the first fault of the application is the first one of the process.
    let outcome = application::run(&plan);
    let floor = floor::measure(&plan);
    let takeovers = outcome.takeovers.iter().map(|(note, all)| {
        let times: Vec<u64> = all.iter().map(|one| one.took_ns).collect();
        let mut allocations: Vec<usize> = all.iter().map(|one| one.allocations).collect();
        allocations.sort_unstable();
        let figures = json!({
            "us": percentiles(&times),
            "allocations": allocations[allocations.len() / 2],
        });
        (note.clone(), figures)
    });
    let takeovers: serde_json::Map<String, Value> = takeovers.collect();
    println!(
        "{}",
        json!({
            "floor_us": percentiles(&floor),
            "takeovers": takeovers,
            "received": outcome.received,
        })
    );
}

/// Median and tail of samples in nanoseconds, in microseconds.
fn percentiles(samples_ns: &[u64]) -> Value {
    let mut sorted = samples_ns.to_vec();
    sorted.sort_unstable();
    let at = |share: f64| {
        let index = (sorted.len().saturating_sub(1) as f64 * share).round() as usize;
        sorted.get(index).map(|ns| *ns as f64 / 1e3)
    };
    json!({"n": sorted.len(), "p50": at(0.5), "p99": at(0.99), "p999": at(0.999), "max": at(1.0)})
}
