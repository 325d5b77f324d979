//! What a host may not do: bounds by rule, and system calls that are refused.

use tests::{Application, Member, Outcome};

use super::{healthy, healthy_missed_nothing};

/// The victim misbehaves once, in its 60th cycle of 100; `isolation` is its rule.
fn application(misbehaviour: &str, isolation: &str) -> Application {
    let victim = Member::new("victim", misbehaviour)
        .property("callback", "onExecute")
        .property("at_cycle", "60");
    healthy().with(&victim).rules(&format!(
        "<component name='victim'>{isolation}<watchdog deadline='60000'/></component>"
    ))
}

fn run(misbehaviour: &str, isolation: &str) -> Outcome {
    let outcome = application(misbehaviour, isolation).simulate("1s");
    let outcome = outcome.ended_well();
    healthy_missed_nothing(&outcome, isolation);
    outcome
}

/// A bound, who runs into it, and what that is.
const BOUNDS: [(&str, &str, &str); 4] = [
    ("memory_limit_kb='65536'", "exhausts_memory", "abort"),
    ("open_files='64'", "exhausts_files", "error_return"),
    ("processor_time_s='1'", "hangs", "host_ended"),
    ("", "kills_parent", "error_return"),
];

#[test]
fn who_runs_into_a_bound_fails_and_is_recovered() {
    for (bound, misbehaviour, kind) in BOUNDS {
        let rule = format!("<isolation {bound}>process</isolation>");
        let outcome = run(misbehaviour, &rule);
        let expected = (kind.to_owned(), "onExecute".to_owned());
        assert_eq!(outcome.faults("victim"), [expected], "{misbehaviour}");
        assert_eq!(outcome.actions(), ["reset victim: done"], "{misbehaviour}");
        let victim = outcome.component("victim");
        assert_eq!(victim["state"], "ACTIVE", "{victim}");
        assert_eq!(victim["incarnation"], 2, "{victim}");
    }
}

/// Without the bound, or with a higher one, the same is no fault.
#[test]
fn who_stays_within_its_bounds_is_left_alone() {
    for (bound, misbehaviour) in [
        ("memory_limit_kb='1048576'", "exhausts_memory"),
        ("", "exhausts_memory"),
        ("open_files='700'", "exhausts_files"),
        ("processor_time_s='100'", "counter"),
    ] {
        let rule = format!("<isolation {bound}>process</isolation>");
        let outcome = run(misbehaviour, &rule);
        assert!(outcome.verdicts().is_empty(), "{misbehaviour} with {bound}");
        assert_eq!(outcome.cycles("victim"), 100, "{misbehaviour}");
    }
}

/// What reaches beyond the process fails with `EPERM`; one attribute turns that off.
#[test]
fn system_calls_that_reach_beyond_the_process_are_refused() {
    let message = |outcome: &Outcome| {
        let faults = outcome.events("fault", "victim");
        let fault = faults.first().expect("it failed");
        fault["message"].as_str().unwrap_or_default().to_owned()
    };
    let filtered = "<isolation>process</isolation>";
    for misbehaviour in ["kills_parent", "leaves_namespace"] {
        let said = message(&run(misbehaviour, filtered));
        assert!(said.contains("Operation not permitted"), "{said}");
    }
    let open = "<isolation system_call_filter='false'>process</isolation>";
    let outcome = run("leaves_namespace", open);
    assert!(outcome.faults("victim").is_empty());
    assert_eq!(outcome.cycles("victim"), 100);
}
