//! A leak is seen: memory that callbacks allocate and do not free has a bound by rule.

use serde_json::Value;
use tests::{Application, Member, Outcome};

/// Half the period: `onExecute` and `onUpdated` of one cycle.
const ONE_CYCLE: &str = "for='5ms'";

/// The counter runs every 10 ms for two seconds; from the first one on every callback forgets so many
/// bytes, for ever or `lasting` so long.
fn run(rule: &str, bytes: usize, lasting: &str) -> Outcome {
    let application = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input");
    let rules = application.write(
        "rules.xml",
        format!(
            "<fault_rules application='application'><component name='counter'>{rule}
             <resurrect><reset>true</reset></resurrect></component></fault_rules>"
        ),
    );
    let injections = application.write(
        "injections.xml",
        format!(
            "<fault_injections application='application'>
             <inject at='1s' component='counter' fault='leak' bytes='{bytes}' {lasting}/>
             </fault_injections>"
        ),
    );
    let path = |path: &std::path::Path| path.display().to_string();
    let arguments = ["--rules", &path(&rules), "--inject", &path(&injections)];
    let simulated = ["--clock", "simulated", "--for", "2s"];
    application.run(&[&simulated[..], &arguments[..]].concat())
}

/// The records of faults about memory, in order.
fn verdicts(outcome: &Outcome) -> Vec<&Value> {
    let events = outcome.events("verdict", "counter");
    let about_memory = events
        .into_iter()
        .filter(|verdict| verdict["kind"] == "memory_exceeded");
    about_memory.collect()
}

#[test]
fn a_leak_is_found_judged_and_ended_by_a_reset() {
    let outcome = run("<memory limit_kb='512'/>", 1 << 20, ONE_CYCLE).ended_well();
    let verdicts = verdicts(&outcome);
    let last = verdicts
        .last()
        .unwrap_or_else(|| panic!("{}", outcome.raw_events()));
    let evidence = &last["evidence"]["memory"];
    assert_eq!(evidence["limit_kb"], 512, "{last}");
    let used = evidence["used_kb"].as_u64().expect("a number");
    assert!((1024..2 * 1024 + 64).contains(&used), "{used}");
    assert_eq!(last["actions"][0]["outcome"], "done", "{last}");
    assert_eq!(outcome.component("counter")["incarnation"], 2);
    assert_eq!(outcome.component("counter")["state"], "ACTIVE");
}

#[test]
fn what_is_below_the_limit_or_without_a_rule_is_no_fault() {
    for rule in ["<memory limit_kb='2048'/>", ""] {
        let outcome = run(rule, 256 << 10, ONE_CYCLE).ended_well();
        assert!(verdicts(&outcome).is_empty(), "{rule}");
        assert_eq!(outcome.component("counter")["incarnation"], 1);
    }
}

#[test]
fn small_leaks_add_up() {
    let rule = "<memory limit_kb='512' severity='stop'><confirm count='2'/></memory>";
    let outcome = run(rule, 64 << 10, "").ended_well();
    let verdicts = verdicts(&outcome);
    let last = verdicts
        .last()
        .unwrap_or_else(|| panic!("{}", outcome.raw_events()));
    let used = last["evidence"]["memory"]["used_kb"]
        .as_u64()
        .expect("a number");
    assert!((513..=640).contains(&used), "found at once: {used}");
    assert_ne!(outcome.component("counter")["state"], "ACTIVE");
}
