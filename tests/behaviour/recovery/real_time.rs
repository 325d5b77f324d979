//! By the machine's clock, each on a thread of its own: what is asked is what happened, never how
//! fast.

use tests::{Application, Member, Outcome};

/// Ways to fail, each in the fifth cycle of every incarnation.
const WAYS: [&str; 11] = [
    "panics",
    "writes_null",
    "divides_by_zero",
    "illegal_instruction",
    "aborts",
    "exits",
    "overflows_stack",
    "bus_error",
    "crashes_in_libc",
    "hangs",
    "hangs_asleep",
];

/// Two resets; then the application goes on without it.
fn expendable(name: &str) -> String {
    format!(
        "<component name='{name}'><severity>reset</severity><fault><retry_max>2</retry_max>\
         <severity>ignore</severity></fault></component>"
    )
}

fn actions_of(outcome: &Outcome, component: &str) -> Vec<String> {
    let actions = outcome.actions();
    let own = actions.into_iter().filter(|action| {
        let words: Vec<&str> = action.split([' ', ':']).collect();
        words.get(1) == Some(&component)
    });
    own.collect()
}

/// All at once, again and again: nobody else misses a datum.
#[test]
fn every_way_to_fail_is_recovered_and_given_up_in_the_end() {
    let mut application = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "counter.output", "recorder.input")
        .rules(&WAYS.map(expendable).concat());
    for way in WAYS {
        application = application.with(&Member::new(way, way));
    }
    let all_given_up = |events: &str| {
        let stops = |way: &str| events.contains(&format!("\"stop {way}\",\"outcome\":\"done\""));
        WAYS.iter().all(|way| stops(way))
    };
    let outcome = application.run_until(all_given_up).ended_well();
    for way in WAYS {
        assert_eq!(outcome.faults(way).len(), 3, "{way}");
        assert_eq!(outcome.component(way)["incarnation"], 3, "{way}");
        assert_eq!(outcome.cycles(way), 12, "{way}: four each");
        let reset = format!("reset {way}: done");
        let expected = [reset.clone(), reset, format!("stop {way}: done")];
        assert_eq!(actions_of(&outcome, way), expected, "{way}");
    }
    for verdict in outcome.verdicts() {
        assert_eq!(verdict["cause"], "root", "{verdict}");
        for time in ["detection_us", "decision_us", "handling_us"] {
            assert!(verdict[time].is_u64(), "{time} of {verdict}");
        }
    }
    for healthy in ["counter", "recorder"] {
        assert_eq!(outcome.component(healthy)["state"], "ACTIVE");
        assert_eq!(outcome.component(healthy)["faults"], 0);
    }
    let logs = outcome.logs("recorder");
    let last = logs.last().map(String::as_str).unwrap_or_default();
    assert!(last.ends_with("gaps 0"), "{last}");
}

/// A source that crashes twice and is replaced at last, on checkpoints all the time: no number comes
/// twice that had been certified, and none comes from an instance that was dead by then.
#[test]
fn a_source_goes_on_where_its_checkpoint_was() {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter").property("remembers", "true"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .with_profile(&Member::new("second", "counter").property("remembers", "true"))
        .connect("data", "counter.output", "recorder.input")
        .rules(
            "<component name='counter'>\
             <resurrect><reset>true</reset><backup>10</backup></resurrect>\
             <fault window='1min'><retry_max>2</retry_max><secondary preload='warm'>\
             <reference>second.xml</reference></secondary></fault></component>",
        )
        .injections(
            "<inject at='300ms' repeat='3' every='300ms' component='counter' fault='abort'/>",
        )
        .run_until(|events| {
            events.matches("\"to\":\"ERROR\"").count() == 3 && {
                let last = events.rfind("\"to\":\"ERROR\"").unwrap_or_default();
                events[last..].matches("got ").count() > 20
            }
        })
        .ended_well();
    assert_eq!(
        outcome.actions(),
        [
            "reset counter: done",
            "reset counter: done",
            "replace counter by second: done"
        ]
    );
    assert_eq!(outcome.component("counter")["incarnation"], 4);
    let notes = outcome.notes();
    assert!(
        notes.iter().all(|note| note.contains("restored")),
        "{notes:?}"
    );
    assert!(notes[2].starts_with("by a warm standby"), "{notes:?}");
    let logs = outcome.logs("recorder");
    let got = logs.iter().filter_map(|line| line.strip_prefix("got "));
    let numbers: Vec<u64> = got
        .flat_map(|line| line.split(' ').filter_map(|it| it.split('=').next()))
        .map(|it| it.parse().expect("a number"))
        .collect();
    // A number that was sent after the last checkpoint may come again, by its successor.
    let steps = numbers.windows(2).map(|two| two[1].abs_diff(two[0]));
    assert!(steps.clone().all(|step| step <= 3), "{numbers:?}");
    let repeated = numbers.windows(2).filter(|two| two[1] <= two[0]).count();
    assert!(repeated <= 3, "{numbers:?}");
    assert!(numbers.last() > Some(&60), "it goes on: {numbers:?}");
}
