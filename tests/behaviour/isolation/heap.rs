//! A heap that is damaged on purpose: in a process of its own that harms nobody else; behind the
//! guard it ends in a verdict that says which tier would have contained it, or with the container.

use tests::{Application, Member, Outcome};

use super::{healthy, healthy_missed_nothing};

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
