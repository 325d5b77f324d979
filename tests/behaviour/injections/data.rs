//! Faults that leave a component running: hangs and delays, and what is done to its data.

use super::{CYCLES, application, word};

/// A fault that leaves the component running: the injection, rules, kind and component of the
/// fault, what is done.
struct Case {
    injection: &'static str,
    rules: &'static str,
    kind: &'static str,
    component: &'static str,
    actions: &'static [&'static str],
}

/// Recovered once; then it goes on without the component.
const ONCE: &str = "<severity>reset</severity><fault window='10s'><retry_max>1</retry_max>\
                    <severity>ignore</severity></fault>";

const RESET_AND_STOPPED: &[&str] = &["reset counter: done", "stop counter: done"];
const RESET: &[&str] = &["reset counter: done"];
const READER_STOPPED: &[&str] = &["stop recorder: done"];

const CASES: [Case; 13] = [
    Case {
        injection: "at='100ms' fault='hang'",
        rules: "<component name='counter'><watchdog deadline='50'/>{ONCE}</component>",
        kind: "hang",
        component: "counter",
        actions: RESET,
    },
    Case {
        injection: "at='100ms' fault='hang'",
        rules: "<component name='counter'><heartbeat period='20' missed='2'/>\
                <watchdog deadline='500'/>{ONCE}</component>",
        kind: "heartbeat_missed",
        component: "counter",
        actions: RESET,
    },
    Case {
        injection: "at='100ms' fault='slow' duration='15ms'",
        rules: "<component name='counter'><overrun tolerated='0' within='100'/>{ONCE}</component>",
        kind: "overrun",
        component: "counter",
        actions: RESET_AND_STOPPED,
    },
    Case {
        injection: "at='100ms' port='output' field='value' fault='out_of_range' value='-7'",
        rules: "<component name='counter'><port name='output'><validity field='value'>\
                <min>0</min><max>1000</max></validity></port>{ONCE}</component>",
        kind: "out_of_range",
        component: "counter",
        actions: RESET_AND_STOPPED,
    },
    Case {
        injection: "at='100ms' port='output' field='value' fault='not_a_number'",
        rules: "<component name='counter'><port name='output'><validity field='value'/></port>\
                {ONCE}</component>",
        kind: "out_of_range",
        component: "counter",
        actions: RESET_AND_STOPPED,
    },
    Case {
        injection: "at='100ms' port='output' field='value' fault='stuck'",
        rules: "<component name='counter'><port name='output'><stuck field='value' count='5'/>\
                </port>{ONCE}</component>",
        kind: "stuck",
        component: "counter",
        actions: RESET_AND_STOPPED,
    },
    Case {
        injection: "at='100ms' port='output' field='value' fault='offset' value='50'",
        rules: "<component name='counter'><port name='output'>\
                <rate_of_change field='value' max='200'/></port>{ONCE}</component>",
        kind: "rate_of_change",
        component: "counter",
        actions: RESET,
    },
    Case {
        injection: "at='100ms' port='output' field='value' fault='drift' per_second='300'",
        rules: "<component name='counter'><port name='output'>\
                <rate_of_change field='value' max='200'/></port>{ONCE}</component>",
        kind: "rate_of_change",
        component: "counter",
        actions: RESET_AND_STOPPED,
    },
    Case {
        injection: "at='100ms' port='output' field='value' fault='noise' deviation='20'",
        rules: "<component name='counter'><port name='output'>\
                <rate_of_change field='value' max='200'/></port>{ONCE}</component>",
        kind: "rate_of_change",
        component: "counter",
        actions: RESET_AND_STOPPED,
    },
    Case {
        injection: "at='100ms' port='output' fault='duplicate'",
        rules: "<component name='counter'><port name='output'><stuck field='number' count='2'/>\
                </port>{ONCE}</component>",
        kind: "stuck",
        component: "counter",
        actions: RESET_AND_STOPPED,
    },
    Case {
        injection: "at='100ms' port='output' fault='drop'",
        rules: "<component name='recorder'><port name='input'><freshness max_age='50' \
                severity='stop'/></port></component>",
        kind: "stale",
        component: "recorder",
        actions: READER_STOPPED,
    },
    Case {
        injection: "at='100ms' port='output' fault='delay' duration='80ms'",
        rules: "<component name='recorder'><port name='input'><freshness max_age='50' \
                severity='stop'/></port></component>",
        kind: "stale",
        component: "recorder",
        actions: READER_STOPPED,
    },
    Case {
        injection: "at='100ms' for='20ms' port='output' field='value' fault='out_of_range' \
                    value='-7'",
        rules: "<component name='counter'><port name='output'><validity field='value' \
                severity='ignore'><min>0</min></validity></port></component>",
        kind: "out_of_range",
        component: "counter",
        actions: &[],
    },
];

#[test]
fn that_leave_it_running_are_found_by_a_detector() {
    for case in &CASES {
        let outcome = application()
            .rules(&case.rules.replace("{ONCE}", ONCE))
            .injections(&format!("<inject component='counter' {}/>", case.injection))
            .simulate("1s")
            .ended_well();
        let context = case.injection;
        let verdicts = outcome.verdicts();
        assert!(!verdicts.is_empty(), "{context}");
        for verdict in verdicts {
            assert_eq!(verdict["kind"], case.kind, "{context}: {verdict}");
            assert_eq!(verdict["component"], case.component, "{context}");
            assert!(
                verdict["confirmed_ns"].as_u64() >= Some(100_000_000),
                "{context}"
            );
            assert!(word(&verdict["rule"]).contains("rules.xml:"), "{context}");
        }
        assert_eq!(outcome.actions(), case.actions, "{context}");
        assert_eq!(outcome.cycles("diary"), CYCLES, "{context}");
    }
}

/// Without the injection none of those rules finds anything.
#[test]
fn no_detector_cries_wolf() {
    for case in &CASES {
        let outcome = application()
            .rules(&case.rules.replace("{ONCE}", ONCE))
            .simulate("1s")
            .ended_well();
        assert!(outcome.verdicts().is_empty(), "{}", case.rules);
        assert_eq!(outcome.cycles("counter"), CYCLES, "{}", case.rules);
    }
}

/// Without a rule nobody can know which data are wrong; a hang is found by the default watchdog.
#[test]
fn that_leave_it_running_without_a_rule() {
    for case in &CASES {
        let outcome = application()
            .injections(&format!("<inject component='counter' {}/>", case.injection))
            .simulate("1s")
            .ended_well();
        let kinds: Vec<&str> = outcome
            .verdicts()
            .iter()
            .map(|verdict| word(&verdict["kind"]))
            .collect();
        if case.injection.contains("hang") {
            assert_eq!(kinds, ["hang"], "{}", case.injection);
            assert_eq!(outcome.actions(), RESET, "{}", case.injection);
        } else {
            assert_eq!(kinds, [""; 0], "{}", case.injection);
            assert_eq!(outcome.component("counter")["incarnation"], 1);
        }
        assert_eq!(outcome.application()["state"], "ACTIVE");
    }
}
