//! Data ports end to end: what an input keeps, and who gets what.

use tests::{Application, Member};

/// Five numbers arrive in each cycle.
fn received(policy: &str, size: usize) -> Vec<String> {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter").property("burst", "5"))
        .with(
            &Member::new("recorder", "recorder")
                .property("verbose", "true")
                .queue(policy, size),
        )
        .connect("data", "counter.output", "recorder.input")
        .simulate("20ms")
        .ended_well();
    let mut logs = outcome.logs("recorder");
    logs.pop();
    logs
}

#[test]
fn an_input_keeps_what_its_policy_says() {
    for (policy, size, first, second) in [
        (
            "FIFO",
            10,
            "got 1=1 2=2 3=3 4=4 5=5",
            "got 6=6 7=7 8=8 9=9 10=10",
        ),
        ("FIFO", 3, "got 3=3 4=4 5=5", "got 8=8 9=9 10=10"),
        (
            "LIFO",
            10,
            "got 5=5 4=4 3=3 2=2 1=1",
            "got 10=10 9=9 8=8 7=7 6=6",
        ),
        ("LIFO", 2, "got 5=5 4=4", "got 10=10 9=9"),
        ("LAST", 1, "got 5=5", "got 10=10"),
    ] {
        assert_eq!(received(policy, size), [first, second], "{policy} {size}");
    }
}

#[test]
fn every_connected_input_gets_its_own_copy() {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("first", "recorder"))
        .with(&Member::new("second", "recorder"))
        .with(&Member::new("apart", "recorder"))
        .connect("data", "counter.output", "first.input")
        .connect("data", "counter.output", "second.input")
        .simulate("100ms")
        .ended_well();
    for (receiver, log) in [
        ("first", "received 10, last 10, gaps 0"),
        ("second", "received 10, last 10, gaps 0"),
        ("apart", "received 0, last 0, gaps 0"),
    ] {
        assert_eq!(outcome.logs(receiver), [log], "{receiver}");
    }
}

/// Two sources into one input cannot be told apart by the receiver.
#[test]
fn a_second_writer_is_refused() {
    Application::new()
        .with(&Member::new("first", "counter"))
        .with(&Member::new("second", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "first.output", "recorder.input")
        .connect("data", "second.output", "recorder.input")
        .simulate("100ms")
        .was_refused(1, &["a second writer", "application.xml:"]);
}

/// Across threads by the machine's clock nothing is lost or reordered while the queue has room.
#[test]
fn nothing_is_lost_in_real_time() {
    let outcome = Application::new()
        .with(
            &Member::new("counter", "counter")
                .period(1)
                .property("burst", "7"),
        )
        .with(
            &Member::new("recorder", "recorder")
                .property("verbose", "true")
                .period(3)
                .queue("FIFO", 60_000),
        )
        .connect("data", "counter.output", "recorder.input")
        .run_until(|events| events.matches("got ").count() > 50)
        .ended_well();
    let logs = outcome.logs("recorder");
    let last = logs.last().map(String::as_str).unwrap_or_default();
    assert!(last.ends_with("gaps 0"), "{last}");
}
