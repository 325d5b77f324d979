//! Data and events around a recovery: what a dead instance had sent, and what it had in work.

use tests::{Application, Member, Outcome};

/// Numbers that the recorder got, in order.
fn received(outcome: &Outcome) -> Vec<u64> {
    let logs = outcome.logs("recorder");
    let got = logs.iter().filter_map(|line| line.strip_prefix("got "));
    let numbers = got.flat_map(|line| line.split(' ').filter_map(|it| it.split('=').next()));
    numbers.map(|it| it.parse().expect("a number")).collect()
}

/// The reader looks every 50 ms. What the old instance has written since is not delivered: the first
/// number that comes after the crash is the new instance's first.
#[test]
fn what_an_old_incarnation_had_sent_is_not_delivered() {
    for (policy, expected) in [
        ("FIFO", vec![1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6, 7, 8]),
        ("LIFO", vec![1, 6, 5, 4, 3, 2, 3, 2, 1, 8, 7, 6, 5, 4]),
        ("LAST", vec![1, 6, 3, 8]),
    ] {
        let recorder = Member::new("recorder", "recorder")
            .period(50)
            .property("verbose", "true")
            .queue(policy, 100);
        let outcome = Application::new()
            .with(&Member::new("counter", "counter").priority(1))
            .with(&recorder)
            .connect("data", "counter.output", "recorder.input")
            .injections("<inject at='80ms' component='counter' fault='panic'/>")
            .simulate("160ms")
            .ended_well();
        assert_eq!(outcome.component("counter")["incarnation"], 2, "{policy}");
        assert_eq!(received(&outcome), expected, "{policy}");
    }
}

/// The datum that it died of is given to a second instance, which may be luckier; when that dies as
/// well the datum is set aside, and the third instance goes on with what follows.
#[test]
fn a_datum_in_work_when_two_died_is_set_aside() {
    for (policy, size, rest) in [
        ("FIFO", 100, vec![4, 5, 6, 7, 8]),
        ("LIFO", 100, vec![4, 5, 6, 7, 8]),
        ("LAST", 1, vec![4, 5, 6, 7, 8]),
    ] {
        let recorder = Member::new("recorder", "recorder")
            .property("verbose", "true")
            .property("chokes_on", "3")
            .queue(policy, size);
        let outcome = Application::new()
            .with(&Member::new("counter", "counter").priority(1))
            .with(&recorder)
            .connect("data", "counter.output", "recorder.input")
            .simulate("80ms")
            .ended_well();
        let choked = outcome.logs("recorder");
        let choked = choked.iter().filter(|line| *line == "choked on 3").count();
        assert_eq!(choked, 2, "{policy}");
        let set_aside = outcome.events("datum_set_aside", "recorder");
        assert_eq!(set_aside.len(), 1, "{policy}");
        assert_eq!(set_aside[0]["port"], "input", "{policy}");
        assert_eq!(set_aside[0]["stamp_ns"], 20_000_000, "{policy}");
        assert_eq!(outcome.component("recorder")["incarnation"], 3, "{policy}");
        let mut expected = vec![1, 2];
        expected.extend(rest);
        assert_eq!(received(&outcome), expected, "{policy}");
        assert!(
            outcome
                .actions()
                .iter()
                .all(|action| action.starts_with("reset recorder: ")),
            "{policy}: {:?}",
            outcome.actions()
        );
    }
}

/// Whoever dies after its work was done, in `onUpdated`, takes no datum along: its successor would
/// pass the same one on again to whoever has read it already. Who has not read it never will: an old
/// incarnation had sent it.
#[test]
fn a_datum_that_was_passed_on_does_not_come_twice() {
    for (callback, expected) in [
        ("onExecute", [1, 2, 3, 4, 5, 6, 7, 8, 9, 10].as_slice()),
        ("onUpdated", &[1, 2, 3, 4, 5, 7, 8, 9, 10]),
    ] {
        let outcome = Application::new()
            .with(&Member::new("counter", "counter").priority(9))
            .with(&Member::new("echo", "echo").priority(8))
            .with(&Member::new("recorder", "recorder").property("verbose", "true"))
            .connect("data", "counter.output", "echo.input")
            .connect("data", "echo.output", "recorder.input")
            .injections(&format!(
                "<inject at='50ms' component='echo' callback='{callback}' fault='panic'/>"
            ))
            .simulate("100ms")
            .ended_well();
        assert_eq!(outcome.component("echo")["incarnation"], 2, "{callback}");
        assert_eq!(received(&outcome), expected, "{callback}");
    }
}

/// Events likewise, in order, none lost but the one.
#[test]
fn an_event_in_work_when_two_died_is_set_aside() {
    for kind in ["periodic", "aperiodic", "passive"] {
        let listener = Member::new("listener", "listener")
            .kind(kind)
            .property("chokes_on", "3");
        let outcome = Application::new()
            .with(&Member::new("herald", "herald").priority(1))
            .with(&listener)
            .connect("event", "herald.news", "listener.news")
            .simulate("100ms")
            .ended_well();
        let heard = outcome.logs("listener");
        let expected = [
            "heard 1", "heard 2", "heard 3", "heard 3", "heard 4", "heard 5",
        ];
        assert_eq!(heard[..6], expected, "{kind}");
        let set_aside = outcome.events("datum_set_aside", "listener");
        assert_eq!(set_aside.len(), 1, "{kind}");
        assert_eq!(set_aside[0]["port"], "news", "{kind}");
        assert_eq!(outcome.component("listener")["state"], "ACTIVE", "{kind}");
    }
}

/// All that was connected stays connected: data in and out, events, calls both ways.
#[test]
fn a_successor_has_the_ports_of_its_predecessor() {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter").priority(9))
        .with(&Member::new("echo", "echo").priority(8))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .with(&Member::new("herald", "herald").priority(9))
        .with(&Member::new("listener", "listener").priority(8))
        .with(&Member::new("adder", "adder").priority(8))
        .with(&Member::new("asker", "asker").priority(7))
        .connect("data", "counter.output", "echo.input")
        .connect("data", "echo.output", "recorder.input")
        .connect("event", "herald.news", "listener.news")
        .connect("service", "asker.arithmetic", "adder.arithmetic")
        .injections(
            "<inject at='50ms' component='echo' fault='panic'/>\
             <inject at='50ms' component='listener' fault='panic'/>\
             <inject at='50ms' component='adder' fault='panic'/>\
             <inject at='50ms' component='asker' fault='panic'/>",
        )
        .simulate("100ms")
        .ended_well();
    for recovered in ["echo", "listener", "adder", "asker"] {
        assert_eq!(
            outcome.component(recovered)["incarnation"],
            2,
            "{recovered}"
        );
        assert_eq!(
            outcome.component(recovered)["state"],
            "ACTIVE",
            "{recovered}"
        );
    }
    assert_eq!(received(&outcome), (1..=10).collect::<Vec<u64>>());
    let heard: Vec<String> = (1..=10).map(|number| format!("heard {number}")).collect();
    assert_eq!(outcome.logs("listener"), heard);
    // Both instances of the asker were answered.
    assert_eq!(outcome.logs("asker"), ["answer 42", "answer 42"]);
}
