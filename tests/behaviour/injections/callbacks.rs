//! Faults in callbacks, each by the rule for that exception, and without any rule.

use tests::Outcome;

use super::{CYCLES, application, word};

/// Faults in callbacks: attributes of the injection, the exception that the rule names, and its
/// kind.
const IN_CALLBACKS: [(&str, &str, &str); 11] = [
    ("fault='panic'", "class='panic'", "panic"),
    ("fault='segfault'", "signal='SIGSEGV'", "segfault"),
    ("fault='bus_error'", "signal='SIGBUS'", "bus_error"),
    (
        "fault='divide_by_zero'",
        "signal='SIGFPE'",
        "divide_by_zero",
    ),
    (
        "fault='illegal_instruction'",
        "signal='SIGILL'",
        "illegal_instruction",
    ),
    ("fault='abort'", "signal='SIGABRT'", "abort"),
    (
        "fault='stack_overflow'",
        "class='stack_overflow'",
        "stack_overflow",
    ),
    ("fault='exit' code='3'", "class='exit'", "exit"),
    (
        "fault='error_return' code='503'",
        "return_code='callee'",
        "error_return",
    ),
    (
        "fault='error_return' code='0x10000000'",
        "return_code='unrecoverable'",
        "error_return",
    ),
    (
        "fault='error_return' code='404'",
        "return_code='404'",
        "error_return",
    ),
];

/// The rule for that very exception counts, not the component's severity.
#[test]
fn in_callbacks_are_judged_by_the_rule_for_that_exception() {
    for (injected, exception, kind) in IN_CALLBACKS {
        let injected = injected.replace("0x10000000", &0x1000_0000.to_string());
        let outcome = application()
            .rules(&format!(
                "<component name='counter'><severity>ignore</severity>\
                 <exception {exception} severity='stop'/></component>\
                 <dependency><name>recorder</name><reference>counter</reference></dependency>"
            ))
            .injections(&format!(
                "<inject at_cycle='5' component='counter' {injected}/>"
            ))
            .simulate("1s")
            .ended_well();
        let verdicts = outcome.verdicts();
        assert_eq!(verdicts.len(), 1, "{injected}: {verdicts:?}");
        let verdict = verdicts[0];
        assert_eq!(verdict["kind"], kind, "{injected}");
        assert_eq!(verdict["component"], "counter", "{injected}");
        assert_eq!(verdict["severity"], "stop", "{injected}");
        assert_eq!(verdict["cause"], "root", "{injected}");
        let rule = word(&verdict["rule"]);
        assert!(rule.contains("rules.xml:"), "{injected}: {rule}");
        // Who needs it is stopped first.
        let actions = ["stop recorder: done", "stop counter: done"];
        assert_eq!(outcome.actions(), actions, "{injected}");
        assert_eq!(outcome.cycles("counter"), 4, "{injected}");
        assert_eq!(outcome.component("recorder")["state"], "INACTIVE");
        assert_eq!(outcome.cycles("diary"), CYCLES, "{injected}");
    }
}

/// Three resets in a minute, then the application stops.
#[test]
fn in_callbacks_are_reset_three_times_without_a_rule() {
    for (injected, _, kind) in IN_CALLBACKS {
        let injected = injected.replace("0x10000000", &0x1000_0000.to_string());
        let outcome = application()
            .injections(&format!(
                "<inject at='100ms' repeat='4' every='100ms' component='counter' {injected}/>"
            ))
            .simulate("1s")
            .ended_well();
        let kinds: Vec<&str> = outcome
            .verdicts()
            .iter()
            .map(|verdict| word(&verdict["kind"]))
            .collect();
        assert_eq!(kinds, [kind; 4], "{injected}");
        stopped_after_three_resets(&outcome, &injected);
    }
}

#[track_caller]
fn stopped_after_three_resets(outcome: &Outcome, context: &str) {
    let actions = outcome.actions();
    assert_eq!(actions[..3], ["reset counter: done"; 3], "{context}");
    let mut stops = actions[3..].to_vec();
    stops.sort();
    let expected = [
        "stop counter: done",
        "stop diary: done",
        "stop recorder: done",
    ];
    assert_eq!(stops, expected, "{context}");
    let verdicts = outcome.verdicts();
    assert!(verdicts[0]["rule"].is_null(), "{context}: a default");
    assert_eq!(outcome.component("counter")["incarnation"], 4, "{context}");
    for stopped in ["recorder", "diary"] {
        assert_eq!(outcome.component(stopped)["state"], "INACTIVE", "{context}");
    }
}
