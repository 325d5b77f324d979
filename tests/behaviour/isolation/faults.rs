//! Every misbehaviour, in a process of its own, in simulated time.

use tests::{Application, Member, Outcome};

use super::super::faults::MISBEHAVIOURS;

/// Cycles in a second of simulated time at 10 ms.
const CYCLES: u64 = 100;

/// The cycle in which it happens: late enough that the successor does not come so far.
const FAULTY_CYCLE: u64 = 60;

/// A faulty component by default rules, all of its ports connected.
fn application(misbehaviour: &str) -> Application {
    let faulty = Member::new("faulty", misbehaviour)
        .property("callback", "onExecute")
        .property("at_cycle", &FAULTY_CYCLE.to_string());
    super::healthy()
        .with(&faulty)
        .with(&Member::new("sink", "recorder"))
        .with(&Member::new("herald", "herald"))
        .with(&Member::new("asker", "asker"))
        .connect("data", "faulty.output", "sink.input")
        .connect("event", "herald.news", "faulty.heard")
        .connect("service", "asker.arithmetic", "faulty.arithmetic")
        .in_hosts()
}

#[test]
fn each_is_recovered_and_nobody_else_misses_anything() {
    for (misbehaviour, kind) in MISBEHAVIOURS {
        let outcome = application(misbehaviour).simulate("1s").ended_well();
        let expected = (kind.to_owned(), "onExecute".to_owned());
        assert_eq!(outcome.faults("faulty"), [expected], "{misbehaviour}");
        assert_eq!(
            outcome.actions(),
            ["reset faulty: done"],
            "{misbehaviour}: {:?}",
            outcome.verdicts()
        );
        // Who can still be called is reset where it is.
        let lives = ["error_return", "bad_pointer"].contains(&kind);
        let notes: &[&str] = if lives { &[] } else { &["by a fresh instance"] };
        assert_eq!(outcome.notes(), notes, "{misbehaviour}");
        let faulty = outcome.component("faulty");
        assert_eq!(faulty["state"], "ACTIVE", "{misbehaviour}: {faulty}");
        assert_eq!(faulty["incarnation"], 2, "{misbehaviour}: {faulty}");
        assert!(outcome.cycles("faulty") >= CYCLES - 1, "{faulty}");
        for healthy in ["counter", "recorder", "sink", "herald", "asker"] {
            let component = outcome.component(healthy);
            assert_eq!(component["tier"], "process", "{component}");
            assert_eq!(component["state"], "ACTIVE", "{misbehaviour}: {component}");
            assert_eq!(component["faults"], 0, "{misbehaviour}: {component}");
            assert_eq!(component["cycles"], CYCLES, "{misbehaviour}: {component}");
        }
        super::healthy_missed_nothing(&outcome, misbehaviour);
    }
}

/// All kinds of ports and executors.
fn all_kinds() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter").priority(9))
        .with(&Member::new("echo", "echo").priority(8))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .with(&Member::new("herald", "herald").priority(9))
        .with(&Member::new("listener", "listener").kind("aperiodic"))
        .with(&Member::new("adder", "adder").kind("passive"))
        .with(&Member::new("asker", "asker").kind("periodic-shared"))
        .with(
            &Member::new("diary", "diary")
                .kind("periodic-shared")
                .property("show", "show"),
        )
        .connect("data", "counter.output", "echo.input")
        .connect("data", "echo.output", "recorder.input")
        .connect("event", "herald.news", "listener.news")
        .connect("service", "asker.arithmetic", "adder.arithmetic")
}

#[track_caller]
fn is_same(one: &Outcome, other: &Outcome) {
    let lines = one.raw_events().lines().zip(other.raw_events().lines());
    for (one, other) in lines {
        assert_eq!(one, other);
    }
    assert!(one.raw_events() == other.raw_events(), "one is longer");
}

#[test]
fn events_of_healthy_components_are_the_same_in_both_tiers() {
    let guarded = all_kinds().simulate("1s").ended_well();
    let hosted = all_kinds().in_hosts().simulate("1s").ended_well();
    assert_eq!(guarded.component("echo")["tier"], "guarded");
    assert_eq!(hosted.component("echo")["tier"], "process");
    assert_eq!(hosted.cycles("echo"), CYCLES);
    is_same(&guarded, &hosted);
}

/// Injected faults of every kind that a callback can have, again and again.
#[test]
fn the_same_seed_gives_the_same_events_whatever_fails() {
    let faults = [
        "panic",
        "segfault",
        "divide_by_zero",
        "illegal_instruction",
        "abort",
        "exit",
        "stack_overflow",
        "hang",
    ];
    let victims = ["echo", "counter", "listener", "diary", "asker", "recorder"];
    let injections: String = (0..)
        .zip(faults)
        .map(|(number, fault)| {
            let victim = victims[number % victims.len()];
            let at_ms = 100 + 70 * number;
            let callback = match victim {
                "listener" => "onEvent",
                _ => "onExecute",
            };
            format!(
                "<inject at='{at_ms}ms' component='{victim}' callback='{callback}' \
                 fault='{fault}'/>"
            )
        })
        .collect();
    let run = || {
        let application = all_kinds().in_hosts().injections(&injections);
        application.simulate("1s").ended_well()
    };
    let (first, second) = (run(), run());
    let faults_seen = first
        .all_events()
        .iter()
        .filter(|event| event["event"] == "fault")
        .count();
    assert_eq!(faults_seen, faults.len(), "{}", first.raw_events());
    is_same(&first, &second);
}
