//! Services: answers, refusals, deadlines, queues.

use tests::{Application, Member, Outcome};

fn application(asker: &Member, adder: &Member) -> Application {
    Application::new().with(asker).with(adder).connect(
        "service",
        "asker.arithmetic",
        "adder.arithmetic",
    )
}

fn simulate(asker: &Member) -> Outcome {
    application(asker, &Member::new("adder", "adder").kind("passive"))
        .simulate("50ms")
        .ended_well()
}

#[test]
fn a_blocking_call_is_answered() {
    let outcome = simulate(&Member::new("asker", "asker"));
    assert_eq!(outcome.logs("asker"), ["answer 42"]);
}

#[test]
fn a_refusal_is_an_answer() {
    let outcome = simulate(&Member::new("asker", "asker").property("number", "-1"));
    assert_eq!(outcome.logs("asker"), ["answer 402 INPUT_OUT_OF_RANGE"]);
    assert_eq!(outcome.component("adder")["state"], "ACTIVE");
    assert_eq!(outcome.application()["state"], "ACTIVE");
    assert_eq!(outcome.cycles("asker"), 5);
}

#[test]
fn a_nonblocking_call_is_queued_in_order() {
    let outcome = simulate(&Member::new("asker", "asker").property("method", "note"));
    assert_eq!(outcome.logs("asker"), ["answer sent"]);
    let notes = outcome.logs("adder");
    assert!(notes.len() >= 4, "{notes:?}");
    let expected: Vec<String> = (1..=notes.len()).map(|n| format!("noted {n}")).collect();
    assert_eq!(notes, expected);
}

/// The provider looks only after a hundred calls: sixteen wait, the others are refused.
#[test]
fn the_queue_of_calls_is_bounded() {
    let asker = Member::new("asker", "asker")
        .priority(2)
        .property("method", "note");
    let adder = Member::new("adder", "adder").priority(1).period(1000);
    let outcome = application(&asker, &adder).simulate("1020ms").ended_well();
    let answers = outcome.logs("asker");
    assert_eq!(
        answers[..3],
        ["answer sent", "answer 408 OUT_OF_RESOURCES", "answer sent"]
    );
    let notes = outcome.logs("adder");
    // One in the first cycle, sixteen that waited for the second.
    let expected: Vec<String> = (1..=17).map(|n| format!("noted {n}")).collect();
    assert_eq!(notes[..17], expected);
}

#[test]
fn a_call_without_a_provider_is_refused() {
    let outcome = Application::new()
        .with(&Member::new("asker", "asker"))
        .simulate("50ms")
        .ended_well();
    assert_eq!(outcome.logs("asker"), ["answer 405 PRECONDITION_NOT_MET"]);
    assert_eq!(outcome.cycles("asker"), 5);
}

/// The provider is busy for two seconds, the caller waits 20 ms at most; later it is answered.
#[test]
fn a_busy_provider_costs_no_more_than_the_deadline() {
    let asker = Member::new("asker", "asker").property("deadline_ms", "20");
    // Two seconds are no hang of a component that runs every second.
    let adder = Member::new("adder", "adder")
        .period(1000)
        .property("busy_ms", "2000");
    let answered_late = |events: &str| {
        let refused = events.find("answer 504");
        refused.is_some_and(|refused| events[refused..].contains("answer 42"))
    };
    let outcome = application(&asker, &adder)
        .run_until(answered_late)
        .ended_well();
    let answers = outcome.logs("asker");
    assert!(
        answers.contains(&"answer 504 TIMED_OUT".to_owned()),
        "{answers:?}"
    );
    assert!(answers.contains(&"answer 42".to_owned()), "{answers:?}");
    assert_eq!(outcome.application()["state"], "ACTIVE");
}
