//! One component fails; it alone goes to ERROR, and the others do not miss a cycle.

use tests::{Application, Member, Outcome};

/// Every misbehaviour with the kind of fault that it is.
const MISBEHAVIOURS: [(&str, &str); 12] = [
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
