//! One component fails; it alone goes to ERROR, and the others do not miss a cycle. Rules say that
//! nothing is recovered here: this is about the fault staying where it is.

use tests::{Application, Member, Outcome};

/// Every misbehaviour with the kind of fault that it is.
pub(super) const MISBEHAVIOURS: [(&str, &str); 13] = [
    ("panics", "panic"),
    ("returns_error", "error_return"),
    ("writes_null", "segfault"),
    ("divides_by_zero", "divide_by_zero"),
    ("illegal_instruction", "illegal_instruction"),
    ("aborts", "abort"),
    ("exits", "exit"),
    ("overflows_stack", "stack_overflow"),
    ("bus_error", "bus_error"),
    ("bad_pointer", "bad_pointer"),
    ("crashes_in_libc", "segfault"),
    ("double_panics", "abort"),
    ("replaces_handlers", "segfault"),
];

/// Cycles in a second of simulated time at 10 ms.
const CYCLES: u64 = 100;

/// A healthy chain beside the faulty component; every port of the latter is connected.
fn application(misbehaviour: &str, callback: &str, call: u64) -> Application {
    let faulty = Member::new("faulty", misbehaviour)
        .property("callback", callback)
        .property("at_cycle", &call.to_string());
    healthy()
        .with(&faulty)
        .with(&Member::new("sink", "recorder"))
        .with(&Member::new("herald", "herald"))
        .with(&Member::new("asker", "asker"))
        .connect("data", "faulty.output", "sink.input")
        .connect("event", "herald.news", "faulty.heard")
        .connect("service", "asker.arithmetic", "faulty.arithmetic")
        .not_recovered(&["faulty", "asker"])
}

fn healthy() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input")
}

/// The healthy ones did all that they had to do.
#[track_caller]
fn nothing_was_missed(outcome: &Outcome) {
    for healthy in ["counter", "recorder", "sink", "herald", "asker"] {
        assert_eq!(outcome.cycles(healthy), CYCLES, "{healthy}");
        assert_eq!(outcome.component(healthy)["state"], "ACTIVE", "{healthy}");
        assert_eq!(outcome.component(healthy)["faults"], 0, "{healthy}");
    }
    assert_eq!(
        outcome.logs("recorder"),
        [format!("received {CYCLES}, last {CYCLES}, gaps 0")]
    );
}

#[test]
fn in_callbacks_of_a_cycle() {
    for (misbehaviour, kind) in MISBEHAVIOURS {
        for callback in ["onExecute", "onUpdated", "onEvent"] {
            let outcome = application(misbehaviour, callback, 5)
                .simulate("1s")
                .ended_well();
            let expected = (kind.to_owned(), callback.to_owned());
            assert_eq!(outcome.faults("faulty"), [expected], "{misbehaviour}");
            assert_eq!(outcome.states("faulty")[2], "ERROR", "{misbehaviour}");
            assert_eq!(outcome.component("faulty")["state"], "ERROR");
            assert_eq!(outcome.application()["state"], "DEGRADED");
            let cycles = outcome.cycles("faulty");
            assert!(
                (4..=5).contains(&cycles),
                "{misbehaviour} {callback}: {cycles}"
            );
            nothing_was_missed(&outcome);
        }
    }
}

/// Before it runs: a crash is contained and the rest runs, a refusal stops the whole start.
#[test]
fn in_callbacks_before_the_first_cycle() {
    for (misbehaviour, kind) in MISBEHAVIOURS {
        for callback in ["onPeriodChanged", "onInitialize", "onStart"] {
            let outcome = application(misbehaviour, callback, 1).simulate("1s");
            if kind == "error_return" {
                outcome.was_refused_after(5, &["'faulty'", callback, "on purpose"]);
                continue;
            }
            let outcome = outcome.ended_well();
            let expected = (kind.to_owned(), callback.to_owned());
            assert_eq!(outcome.faults("faulty"), [expected], "{misbehaviour}");
            let context = format!("{misbehaviour} in {callback}");
            assert_eq!(outcome.component("faulty")["state"], "ERROR", "{context}");
            assert_eq!(outcome.application()["state"], "DEGRADED", "{context}");
            assert_eq!(outcome.cycles("faulty"), 0, "{context}");
            nothing_was_missed(&outcome);
        }
    }
}

/// While it is stopped: the run is over, but the others are stopped in order all the same.
#[test]
fn in_callbacks_after_the_last_cycle() {
    for (misbehaviour, kind) in MISBEHAVIOURS {
        for callback in ["onStop", "onDestroy"] {
            let outcome = application(misbehaviour, callback, 1)
                .simulate("1s")
                .ended_well();
            let expected = (kind.to_owned(), callback.to_owned());
            assert_eq!(outcome.faults("faulty"), [expected], "{misbehaviour}");
            assert_eq!(outcome.cycles("faulty"), CYCLES);
            nothing_was_missed(&outcome);
            for healthy in ["counter", "recorder"] {
                let states = outcome.states(healthy);
                assert_eq!(
                    states,
                    ["READY", "ACTIVE", "INACTIVE", "DESTROYED"],
                    "{healthy}"
                );
            }
        }
    }
}

/// In a service: the caller gets an answer and goes on, unless its own thread was lost inside.
#[test]
fn in_a_call_of_another_component() {
    for (misbehaviour, kind) in MISBEHAVIOURS {
        let outcome = application(misbehaviour, "onCall", 5)
            .simulate("1s")
            .ended_well();
        let answers = outcome.logs("asker");
        if kind == "error_return" {
            // Saying no is an answer, not a fault.
            let expected = ["answer 42", "answer 502 INTERNAL_FAULT", "answer 42"];
            assert_eq!(answers, expected, "{misbehaviour}");
            assert_eq!(outcome.component("faulty")["state"], "ACTIVE");
            continue;
        }
        let expected = (kind.to_owned(), "onCall".to_owned());
        assert_eq!(outcome.faults("faulty"), [expected], "{misbehaviour}");
        assert_eq!(
            outcome.component("faulty")["state"],
            "ERROR",
            "{misbehaviour}"
        );
        assert_eq!(outcome.application()["state"], "DEGRADED");
        if misbehaviour == "crashes_in_libc" {
            assert_eq!(answers, ["answer 42"]);
            assert_eq!(outcome.component("asker")["state"], "ERROR");
        } else {
            let refused = "answer 405 PRECONDITION_NOT_MET";
            let expected = ["answer 42", "answer 502 INTERNAL_FAULT", refused];
            assert_eq!(answers, expected, "{misbehaviour}");
            assert_eq!(outcome.cycles("asker"), CYCLES, "{misbehaviour}");
        }
        for healthy in ["counter", "recorder", "sink", "herald"] {
            assert_eq!(outcome.cycles(healthy), CYCLES, "{misbehaviour}: {healthy}");
        }
    }
}

/// All at once, each on a thread of its own, by the machine's clock.
#[test]
fn all_at_once_in_real_time() {
    let mut application = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "counter.output", "recorder.input");
    for (misbehaviour, _) in MISBEHAVIOURS {
        application = application
            .with(&Member::new(misbehaviour, misbehaviour))
            .with(&Member::new(&format!("sink_of_{misbehaviour}"), "recorder"))
            .connect(
                "data",
                &format!("{misbehaviour}.output"),
                &format!("sink_of_{misbehaviour}.input"),
            );
    }
    let application = application.not_recovered(&MISBEHAVIOURS.map(|(name, _)| name));
    // The healthy ones go on long after the last fault.
    let outlived = |events: &str| {
        let faults = events.match_indices("\"event\":\"fault\"");
        let last = faults.skip(MISBEHAVIOURS.len() - 1).last();
        last.is_some_and(|(last, _)| events[last..].matches("got ").count() > 20)
    };
    let outcome = application.run_until(outlived).ended_well();
    for (misbehaviour, kind) in MISBEHAVIOURS {
        let expected = (kind.to_owned(), "onExecute".to_owned());
        assert_eq!(outcome.faults(misbehaviour), [expected], "{misbehaviour}");
        assert_eq!(outcome.component(misbehaviour)["state"], "ERROR");
        assert_eq!(outcome.cycles(misbehaviour), 4, "{misbehaviour}");
        let lost = &outcome.events("fault", misbehaviour)[0]["thread_lost"];
        assert_eq!(*lost, misbehaviour == "crashes_in_libc", "{misbehaviour}");
        // What was sent before the fault was received; only a bad pointer lets the callback go on.
        let sent = if misbehaviour == "bad_pointer" { 5 } else { 4 };
        let sink = outcome.logs(&format!("sink_of_{misbehaviour}"));
        assert_eq!(
            sink,
            [format!("received {sent}, last {sent}, gaps 0")],
            "{misbehaviour}"
        );
    }
    assert_eq!(outcome.application()["state"], "DEGRADED");
    assert_eq!(outcome.component("counter")["state"], "ACTIVE");
    let logs = outcome.logs("recorder");
    let last = logs.last().map(String::as_str).unwrap_or_default();
    assert!(last.ends_with("gaps 0"), "{last}");
}

/// The fault says where in the source, for a panic.
#[test]
fn a_panic_tells_its_text_and_place() {
    let outcome = application("panics", "onExecute", 1)
        .simulate("50ms")
        .ended_well();
    let fault = outcome.events("fault", "faulty")[0];
    assert_eq!(fault["message"], "on purpose");
    let place = fault["place"].as_str().expect("a panic has a place");
    assert!(
        place.starts_with("tests/faulty-components/panics/src/lib.rs:"),
        "{place}"
    );
    assert_eq!(fault["t_ns"], 0);
    assert_eq!(fault["incarnation"], 1);
}

/// What it asked of the signals that the guard needs is refused and on record, once.
#[test]
fn who_meddles_with_signals_is_named() {
    for (way, function) in [
        ("replaces_handlers", "sigaction"),
        ("blocks_signals", "pthread_sigmask"),
    ] {
        let outcome = application(way, "onExecute", 1)
            .simulate("100ms")
            .ended_well();
        let refusal = format!(
            "{function}: signals that the guard needs keep their handlers and stay unblocked"
        );
        assert_eq!(outcome.logs("faulty"), [refusal], "{way}");
    }
}

/// A thread that the component made itself fails, in the component's code or below it in the C
/// library: the thread stops, the component is in ERROR, the rest goes on.
#[test]
fn in_a_thread_of_the_component() {
    for (misbehaviour, kind) in [
        ("crashes_in_thread", "segfault"),
        ("aborts_in_thread", "abort"),
    ] {
        for execution in ["periodic", "aperiodic"] {
            let faulty = Member::new("faulty", misbehaviour)
                .kind(execution)
                .property("callback", "onEvent")
                .property("at_cycle", "1");
            let application = healthy()
                .with(&faulty)
                .with(&Member::new("herald", "herald"))
                .connect("event", "herald.news", "faulty.heard")
                .not_recovered(&["faulty"]);
            let outcome = application
                .run_until(|events| events.contains("\"event\":\"fault\""))
                .ended_well();
            let expected = (kind.to_owned(), "a thread of its own".to_owned());
            assert_eq!(outcome.faults("faulty"), [expected], "{misbehaviour}");
            assert_eq!(outcome.component("faulty")["state"], "ERROR");
            assert_eq!(outcome.component("recorder")["state"], "ACTIVE");
        }
    }
}
