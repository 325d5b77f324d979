//! Events: in order, bounded, and only to those who live.

use tests::{Application, Member};

fn heard(numbers: impl IntoIterator<Item = u64>) -> Vec<String> {
    numbers
        .into_iter()
        .map(|number| format!("heard {number}"))
        .collect()
}

#[test]
fn in_order_to_every_receiver_of_every_kind() {
    for kind in ["periodic", "passive", "aperiodic", "periodic-shared"] {
        let outcome = Application::new()
            .with(&Member::new("herald", "herald").property("burst", "3"))
            .with(&Member::new("near", "listener").kind(kind))
            .with(&Member::new("far", "listener").kind(kind))
            .connect("event", "herald.news", "near.news")
            .connect("event", "herald.news", "far.news")
            .simulate("50ms")
            .ended_well();
        for listener in ["near", "far"] {
            let all: Vec<String> = outcome.logs(listener);
            // A receiver that looks before the sender has sent gets the last ones no more.
            assert!(all.len() >= 12, "{kind} {listener}: {all:?}");
            assert_eq!(all, heard(1..=all.len() as u64), "{kind} {listener}");
        }
    }
}

#[test]
fn bounded_and_refused_aloud() {
    let outcome = Application::new()
        .with(
            &Member::new("herald", "herald")
                .property("burst", "100")
                .priority(2),
        )
        .with(&Member::new("listener", "listener").priority(1))
        .connect("event", "herald.news", "listener.news")
        .simulate("20ms")
        .ended_well();
    assert_eq!(outcome.logs("listener"), heard((1..=64).chain(101..=164)));
    assert_eq!(
        outcome.logs("herald"),
        [
            "refused from 65: 408 OUT_OF_RESOURCES",
            "refused from 165: 408 OUT_OF_RESOURCES"
        ]
    );
}

#[test]
fn not_to_a_component_in_error() {
    let outcome = Application::new()
        .with(&Member::new("herald", "herald").priority(2))
        .with(
            &Member::new("listener", "listener")
                .priority(1)
                .property("fails_at", "3"),
        )
        .connect("event", "herald.news", "listener.news")
        .not_recovered(&["listener"])
        .simulate("1s")
        .ended_well();
    assert_eq!(outcome.component("listener")["state"], "ERROR");
    assert_eq!(outcome.logs("listener"), heard(1..=3));
    // What is not delivered is thrown away: the sender never finds the queue full.
    assert_eq!(outcome.logs("herald"), [""; 0]);
    assert_eq!(outcome.cycles("herald"), 100);
}

#[test]
fn in_real_time() {
    let outcome = Application::new()
        .with(&Member::new("herald", "herald").period(5))
        .with(&Member::new("listener", "listener").kind("aperiodic"))
        .connect("event", "herald.news", "listener.news")
        .run_until(|events| events.matches("heard ").count() > 50)
        .ended_well();
    let all = outcome.logs("listener");
    assert!(!all.is_empty());
    assert_eq!(all, heard(1..=all.len() as u64));
}
