//! A heap that is damaged on purpose: in a process of its own that harms nobody else; behind the
//! guard it ends in a verdict that says which tier would have contained it, or with the container.

use std::time::Duration;

use tests::{Application, Member, Outcome};

use super::{healthy, healthy_missed_nothing};

/// It ends seconds after the damage was done; a busy machine gets more.
const LIMIT: Duration = Duration::from_secs(60);

/// Damages its heap once, in its 60th cycle.
fn application() -> Application {
    let vandal = Member::new("vandal", "corrupts_heap")
        .property("callback", "onExecute")
        .property("at_cycle", "60");
    healthy().with(&vandal)
}

/// Whatever the C library makes of it: the fault is the vandal's, and it comes back.
#[track_caller]
fn is_contained(outcome: &Outcome) {
    assert_eq!(
        outcome.faults("vandal").len(),
        1,
        "{:?}",
        outcome.faults("vandal")
    );
    assert_eq!(outcome.actions(), ["reset vandal: done"]);
    let vandal = outcome.component("vandal");
    assert_eq!(vandal["state"], "ACTIVE", "{vandal}");
    assert_eq!(vandal["incarnation"], 2, "{vandal}");
    healthy_missed_nothing(outcome, "the heap of a neighbour was damaged");
}

#[test]
fn in_a_process_of_its_own_it_harms_nobody() {
    let rule = "<component name='vandal'><isolation>process</isolation></component>";
    for _ in 0..5 {
        let outcome = application().rules(rule).simulate("1s").ended_well();
        is_contained(&outcome);
        assert!(!outcome.raw_events().contains("\"damage\""));
    }
}

/// The C library has stopped in the middle of its books, with their lock: nobody can go on for long.
/// What could still be judged says that another tier would have contained it; the last words do.
#[test]
fn behind_the_guard_it_is_the_end_of_the_container_which_says_what_would_have_helped() {
    const ADVICE: &str = "<isolation>process</isolation> would have contained this";
    for clock in ["simulated", "real"] {
        for _ in 0..5 {
            let application = application();
            let run = application.start(&["--clock", clock, "--for", "1h"]);
            let finished = run.wait(LIMIT);
            assert_eq!(finished.code, None, "{clock}: {finished}");
            assert!(finished.stderr.contains(ADVICE), "{clock}: {finished}");
            let outcome = application.outcome(finished);
            for verdict in outcome.verdicts() {
                let damage = verdict["evidence"]["exception"]["damage"].as_str();
                let says = damage.is_some_and(|text| text.contains(ADVICE));
                assert!(says || verdict["component"] != "vandal", "{verdict}");
            }
        }
    }
}

/// A wild pointer that was caught may not have been the first: the verdict says so.
#[test]
fn a_segmentation_fault_behind_the_guard_says_what_it_may_have_damaged() {
    let damage = |fault: &str, rules: &str| {
        let outcome = healthy()
            .rules(rules)
            .injections(&format!(
                "<inject at='500ms' component='counter' fault='{fault}'/>"
            ))
            .simulate("1s")
            .ended_well();
        let verdicts = outcome.verdicts();
        let evidence = &verdicts.first().expect("it failed")["evidence"]["exception"];
        assert!(evidence["callback"].is_string(), "{evidence}");
        evidence["damage"].as_str().map(ToOwned::to_owned)
    };
    let hosted = "<component name='counter'><isolation>process</isolation></component>";
    let text = damage("segfault", "").expect("it may have done damage");
    assert!(
        text.contains("memory of other components may be damaged"),
        "{text}"
    );
    assert_eq!(damage("segfault", hosted), None);
    for clean in ["panic", "divide_by_zero", "exit", "stack_overflow"] {
        assert_eq!(damage(clean, ""), None, "{clean}");
    }
}
