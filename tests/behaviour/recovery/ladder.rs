//! The ladder: resets within their budget, secondaries in order, and what climbs.

use tests::{Application, Member, Outcome};

/// A counter with a budget, and profiles of two that may take its place: they send two and three
/// numbers in each cycle.
fn application(rules: &str, injections: &str) -> Application {
    let spare = |name: &str, burst: &str| {
        Member::new(name, "counter")
            .property("remembers", "true")
            .property("burst", burst)
    };
    Application::new()
        .with(&Member::new("counter", "counter").property("remembers", "true"))
        .with(&Member::new("recorder", "recorder"))
        .with(&Member::new("diary", "diary"))
        .with_profile(&spare("second", "2"))
        .with_profile(&spare("third", "3"))
        .connect("data", "counter.output", "recorder.input")
        .rules(&format!("<component name='counter'>{rules}</component>"))
        .injections(injections)
}

fn run(rules: &str, injections: &str) -> Outcome {
    application(rules, injections).simulate("1s").ended_well()
}

/// Crashes at 100 ms, 200 ms, ...
fn crashes(times: u32) -> String {
    format!("<inject at='100ms' repeat='{times}' every='100ms' component='counter' fault='panic'/>")
}

/// When the component entered a state, in milliseconds.
fn entered_ms(outcome: &Outcome, state: &str) -> Vec<u64> {
    let events = outcome.events("state", "counter");
    let entered = events.into_iter().filter(|event| event["to"] == state);
    let times = entered.filter_map(|event| event["t_ns"].as_u64());
    times.map(|time_ns| time_ns / 1_000_000).collect()
}

#[test]
fn resets_have_a_budget_within_a_window() {
    const STOPPED: &str = "stop counter: done";
    const RESET: &str = "reset counter: done";
    for (fault, times, actions) in [
        (
            "<fault window='10s'><retry_max>1</retry_max>",
            2,
            &[RESET, STOPPED][..],
        ),
        (
            "<fault window='10s'><retry_max>0</retry_max>",
            1,
            &[STOPPED],
        ),
        (
            "<fault window='10s'><retry_max>3</retry_max>",
            4,
            &[RESET, RESET, RESET, STOPPED],
        ),
        (
            "<fault window='150ms'><retry_max>2</retry_max>",
            8,
            &[RESET; 8],
        ),
        (
            "<fault window='150ms'><retry_max>1</retry_max>",
            8,
            &[RESET, STOPPED],
        ),
    ] {
        let rules = format!("{fault}<severity>ignore</severity></fault>");
        let outcome = run(&rules, &crashes(times));
        assert_eq!(outcome.actions(), actions, "{fault}");
        assert_eq!(outcome.component("diary")["state"], "ACTIVE", "{fault}");
    }
}

/// The first reset comes at once, the next one no sooner than the backoff after it.
#[test]
fn resets_keep_a_distance() {
    let outcome = run(
        "<fault window='10s' backoff='250ms'><retry_max>3</retry_max></fault>",
        &crashes(2),
    );
    assert_eq!(entered_ms(&outcome, "ERROR"), [100, 200]);
    assert_eq!(entered_ms(&outcome, "READY"), [0, 100, 350]);
    assert_eq!(outcome.component("counter")["incarnation"], 3);
    let handled = outcome.verdicts()[1]["handling_us"].as_u64();
    assert_eq!(handled, Some(150_000));
}

#[test]
fn a_secondary_takes_over_as_ready_as_it_was_kept() {
    for (preload, readiness) in [
        ("cold", "by a fresh instance"),
        ("loaded", "by a loaded standby"),
        ("warm", "by a warm standby"),
    ] {
        let outcome = run(
            &format!(
                "<resurrect><reset>true</reset><backup>10</backup></resurrect>\
                 <fault><retry_max>0</retry_max><secondary preload='{preload}'>\
                 <reference>second.xml</reference></secondary></fault>"
            ),
            &crashes(1),
        );
        assert_eq!(outcome.actions(), ["replace counter by second: done"]);
        // Ten numbers were sent, and the successor goes on from there, two at a time.
        assert_eq!(
            outcome.notes(),
            [format!("{readiness}, checkpoint 10 restored")]
        );
        assert_eq!(outcome.component("counter")["incarnation"], 2, "{preload}");
        assert_eq!(outcome.cycles("counter"), 100, "{preload}");
        assert_eq!(
            outcome.logs("recorder"),
            [format!("received {0}, last {0}, gaps 0", 10 + 2 * 90)],
            "{preload}"
        );
    }
}

#[test]
fn secondaries_follow_in_the_order_written_and_have_budgets_of_their_own() {
    let rules = "<fault><retry_max>1</retry_max>\
                 <secondary preload='warm'><reference>second.xml</reference></secondary>\
                 <secondary preload='cold'><reference>third.xml</reference></secondary>\
                 <severity>ignore</severity></fault>";
    let outcome = run(rules, &crashes(6));
    assert_eq!(
        outcome.actions(),
        [
            "reset counter: done",
            "replace counter by second: done",
            "reset counter: done",
            "replace counter by third: done",
            "reset counter: done",
            "stop counter: done",
        ]
    );
    assert_eq!(outcome.component("diary")["state"], "ACTIVE");
}

/// An attempt that fails is over; the next rung is tried at once.
#[test]
fn a_recovery_that_fails_climbs() {
    let rules = "<fault><retry_max>1</retry_max>\
                 <secondary preload='cold'><reference>second.xml</reference></secondary>\
                 <secondary preload='cold'><reference>third.xml</reference></secondary></fault>";
    for (failure, actions) in [
        (
            // The fresh instance panics in its turn.
            "<inject at='90ms' component='counter' callback='onInitialize' fault='panic'/>",
            &["reset counter: failed", "replace counter by second: done"][..],
        ),
        (
            "<inject at='90ms' component='counter' callback='onStart' fault='segfault'/>",
            &["reset counter: failed", "replace counter by second: done"],
        ),
        (
            "<inject at='90ms' component='counter' callback='onInitialize' fault='error_return' \
             code='503'/>",
            &["reset counter: failed", "replace counter by second: done"],
        ),
        (
            // It comes up, and crashes in its first cycle.
            "<inject at='100ms' component='counter' fault='abort'/>",
            &["reset counter: failed", "replace counter by second: done"],
        ),
    ] {
        let outcome = run(rules, &(failure.to_owned() + &crashes(1)));
        assert_eq!(outcome.actions(), actions, "{failure}");
        assert_eq!(outcome.component("counter")["state"], "ACTIVE", "{failure}");
    }
}

#[test]
fn a_secondary_that_cannot_be_made_is_passed_over() {
    let rules = "<fault><retry_max>0</retry_max>\
                 <secondary preload='cold'><reference>second.xml</reference></secondary>\
                 <secondary preload='cold'><reference>third.xml</reference></secondary></fault>";
    let missing = "<inject at='90ms' component='counter' fault='library_missing'/>";
    let outcome = run(rules, &(missing.to_owned() + &crashes(1)));
    let actions = [
        "replace counter by second: failed",
        "replace counter by third: done",
    ];
    assert_eq!(outcome.actions(), actions);
    assert!(outcome.notes()[0].contains("missing (injected)"));
}

/// The second reset is not followed by a cycle at once, and the next one comes too late.
#[test]
fn an_overdue_recovery_climbs() {
    let rules = "<recovery deadline='20'/><fault><retry_max>2</retry_max>\
                 <secondary preload='cold'><reference>second.xml</reference></secondary></fault>";
    let injections = "<inject at='200ms' component='slow' fault='panic'/>\
                      <inject at='200ms' component='slow' fault='panic'/>";
    let outcome = Application::new()
        .with(&Member::new("slow", "counter").period(100))
        .with(&Member::new("diary", "diary"))
        .with_profile(&Member::new("second", "counter").period(100))
        .rules(&format!("<component name='slow'>{rules}</component>"))
        .injections(injections)
        .simulate("1s")
        .ended_well();
    assert_eq!(
        outcome.actions()[..3],
        [
            "reset slow: failed",
            "reset slow: overdue",
            "replace slow by second: overdue"
        ]
    );
    assert_eq!(outcome.component("diary")["state"], "INACTIVE");
}

/// Two components fail while a third one waits for its reset: each is recovered.
#[test]
fn faults_during_a_recovery_are_not_lost() {
    let outcome = application(
        "<fault window='10s' backoff='300ms'><retry_max>3</retry_max></fault>",
        &(crashes(2)
            + "<inject at='250ms' component='recorder' fault='segfault'/>\
               <inject at='300ms' component='diary' fault='error_return' code='503'/>"),
    )
    .simulate("1s")
    .ended_well();
    assert_eq!(entered_ms(&outcome, "READY"), [0, 100, 400]);
    let mut actions = outcome.actions();
    actions.sort();
    assert_eq!(
        actions,
        [
            "reset counter: done",
            "reset counter: done",
            "reset diary: done",
            "reset recorder: done"
        ]
    );
    for component in ["counter", "recorder", "diary"] {
        assert_eq!(
            outcome.component(component)["state"],
            "ACTIVE",
            "{component}"
        );
    }
}

/// Its reader has nothing to read while a source waits for its reset: that is recorded as the
/// consequence that it is, and the reader is left alone.
#[test]
fn a_consequence_starts_no_recovery() {
    let outcome = application(
        "<fault window='10s' backoff='300ms'><retry_max>3</retry_max></fault>",
        &crashes(2),
    )
    .rules(
        "<component name='recorder'><port name='input'><freshness max_age='50'/></port>\
         <severity>reset</severity></component>\
         <dependency><name>recorder</name><reference>counter</reference></dependency>",
    )
    .simulate("1s")
    .ended_well();
    assert_eq!(outcome.actions(), ["reset counter: done"; 2]);
    let verdicts = outcome.verdicts();
    let of_reader: Vec<_> = verdicts
        .iter()
        .filter(|verdict| verdict["component"] == "recorder")
        .collect();
    assert_eq!(of_reader.len(), 1, "{verdicts:#?}");
    assert_eq!(of_reader[0]["kind"], "stale");
    let second = &verdicts[1];
    assert_eq!(second["component"], "counter");
    assert_eq!(of_reader[0]["cause"]["consequence_of"], second["id"]);
    assert_eq!(outcome.component("recorder")["incarnation"], 1);
    assert_eq!(outcome.component("recorder")["state"], "ACTIVE");
}
