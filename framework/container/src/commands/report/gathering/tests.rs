use serde_json::json;

use super::*;

fn gathered(events: &[Value]) -> Gathering {
    let mut gathering = Gathering::new("events.jsonl".to_owned());
    for event in events {
        gathering.learn(event).expect("an event");
    }
    gathering
}

#[test]
fn the_last_verdict_of_an_id_counts() {
    let verdict = |t_ns: u64, state: &str| {
        json!({"t_ns": t_ns, "event": "verdict", "id": 3, "state": state, "confirmed_ns": 5,
               "handling_us": 2})
    };
    for (states, state, healed_ns) in [
        (&["CONFIRMED"][..], "CONFIRMED", None),
        (&["CONFIRMED", "HEALED", "CLEARED"], "CLEARED", Some(1)),
        (&["HEALED", "CONFIRMED"], "CONFIRMED", None),
    ] {
        let events = states.iter().zip(0..);
        let events: Vec<Value> = events.map(|(state, at)| verdict(at, state)).collect();
        let run = gathered(&events).finish();
        let fault = &run.faults[&FaultNumber {
            container: 1,
            id: 3,
        }];
        assert_eq!(fault.verdict.state, state);
        assert_eq!(fault.healed_ns, healed_ns, "{states:?}");
        assert_eq!(fault.end_ns(), Some(healed_ns.unwrap_or(2005)));
    }
}

#[test]
fn a_second_container_counts_its_own_faults() {
    let started = |name: &str| json!({"t_ns": 0, "event": "run_started", "application": name});
    let verdict = || json!({"t_ns": 1, "event": "verdict", "id": 1});
    for (events, application, expected) in [
        (vec![verdict()], "", &["1"][..]),
        (vec![started("a"), started("b"), verdict()], "a + b", &["1"]),
        (
            vec![started("a"), verdict(), started("a"), verdict()],
            "a",
            &["1", "2.1"],
        ),
    ] {
        let run = gathered(&events).finish();
        let labels: Vec<String> = run.faults.keys().map(ToString::to_string).collect();
        assert_eq!(labels, expected, "{events:?}");
        assert_eq!(run.application, application);
    }
}

#[test]
fn what_is_told_twice_is_known() {
    let event = json!({"t_ns": 7, "event": "notice", "message": "low battery"});
    let gathering = gathered(std::slice::from_ref(&event));
    assert!(gathering.knows(&event));
    assert!(!gathering.knows(&json!({"t_ns": 8, "event": "notice"})));
    assert_eq!(gathering.run.incidents[0].text, "low battery");
}

#[test]
fn what_is_no_event_is_refused_and_what_is_unknown_passed_over() {
    let mut gathering = Gathering::default();
    for (event, refused) in [
        (json!({"t_ns": 0, "event": "of a later version"}), false),
        (json!({"t_ns": 0, "event": "verdict", "id": "one"}), true),
        (json!({"event": "state"}), true),
        (json!(["t_ns"]), true),
    ] {
        assert_eq!(gathering.learn(&event).is_err(), refused, "{event}");
    }
}

#[test]
fn incidents_have_a_bound_and_say_so() {
    let notice = json!({"t_ns": 7, "event": "notice", "message": "again"});
    let events = vec![notice; MOST_INCIDENTS + 3];
    let run = gathered(&events).finish();
    assert_eq!(run.incidents.len(), MOST_INCIDENTS + 1);
    assert!(run.incidents[MOST_INCIDENTS].text.contains("3 more"));
}
